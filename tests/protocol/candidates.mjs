// Values of a parameter that its schema in server/net/asyncapi.yaml allows, up to its limits, and values just beyond.
import { lookUp } from "./asyncapi.mjs";

export function resolved(schema) {
  return schema.$ref ? { ...resolved(lookUp(schema.$ref)), ...schema, $ref: undefined } : schema;
}

const numbers = ({ type, minimum, maximum }) => ({
  good: [minimum, maximum].filter((value) => value !== undefined),
  bad: [
    minimum === undefined ? [] : [minimum - (type === "integer" ? 1 : Math.abs(minimum) * 1e-6 + 1e-9)],
    maximum === undefined ? [] : [maximum + (type === "integer" ? 1 : Math.abs(maximum) * 1e-6)],
    type === "integer" ? [minimum + 0.5] : [],
    "1",
    true,
    [],
  ].flat(),
});

/// Values { good, bad } for a schema.
export function candidates(given) {
  const schema = resolved(given);
  if (schema.const === true) return { good: [true], bad: [false, 1, "true", []] };
  if (schema.enum)
    return { good: schema.enum, bad: ["no such", 5, ...schema.enum.map((value) => value.toUpperCase())] };
  switch (schema.type) {
    case "integer":
    case "number":
      return numbers(schema);
    case "boolean":
      return { good: [true, false], bad: [0, "true", []] };
    case "string":
      return { good: ["x".repeat(schema.minLength ?? 0), "anything"], bad: [5, {}, ...(schema.minLength ? [""] : [])] };
    case "array": {
      const item = candidates(schema.items);
      const full = (length) => Array.from({ length }, (_, i) => item.good[i % item.good.length]);
      const { minItems: least = 0, maxItems: most } = schema;
      if (least > 0)
        return {
          good: [full(least), full(most)],
          bad: ["x", {}, [], full(least - 1), full(most + 1), ...item.bad.map((value) => [...full(least - 1), value])],
        };
      return {
        good: [[], item.good, ...(schema.maxItems ? [full(schema.maxItems)] : [])],
        bad: ["x", {}, ...item.bad.map((value) => [value]), ...(schema.maxItems ? [full(schema.maxItems + 1)] : [])],
      };
    }
    case undefined:
      return { good: [null, 1, "x", [{}]], bad: [] };
    default: // several types
      return { good: schema.type.map((type) => ({ object: {}, array: [] })[type]), bad: [5, "x", true] };
  }
}
