// The names that a session may have, which the server refuses in a way that a browser does not tell the page.

/// What is wrong with the name, and what is allowed; "" if nothing is.
export function sessionFault(name: string): string {
  if (/^[\w-]{1,64}$/.test(name)) return "";
  const count = [...name].length;
  const found = count > 64 ? `a name of ${count} characters` : name === "" ? "an empty name" : `“${name}”`;
  const allowed = "Allowed are 1 to 64 of the letters a to z and A to Z, digits, - and _.";
  return `The address asks for a session by ${found}, which none can have. ${allowed}`;
}
