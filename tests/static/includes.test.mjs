// A file includes what it needs, itself or through our own headers: headers of the standard library, as one that comes
// only through the library's own headers may be missing with another version of the compiler; and our own, as one that
// another source of the same unity build includes is missing when each is compiled alone.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

const root = fileURLToPath(new URL("../../", import.meta.url));

/// Names of namespace std, and the headers that declare them, of which any one is enough.
const headers = {
  "int8_t|int16_t|int32_t|int64_t|uint8_t|uint16_t|uint32_t|uint64_t|intptr_t|uintptr_t|intmax_t|uintmax_t": "cstdint",
  "byte|max_align_t|ptrdiff_t": "cstddef",
  size_t: "cstddef cstring cstdlib cstdio string vector array string_view span",
  "string|to_string|stoi|stol|stoul|stoull|stod|stof|getline": "string",
  string_view: "string_view",
  vector: "vector",
  array: "array",
  deque: "deque",
  list: "list",
  "map|multimap": "map",
  "set|multiset": "set",
  unordered_map: "unordered_map",
  unordered_set: "unordered_set",
  span: "span",
  "tuple|tie|make_tuple|apply": "tuple",
  "optional|nullopt|nullopt_t": "optional",
  "variant|visit|get_if|holds_alternative|monostate": "variant",
  function: "functional",
  "greater|hash|invoke|reference_wrapper|ref|cref|plus|multiplies": "functional",
  "unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared|addressof": "memory",
  move: "utility algorithm",
  swap: "utility",
  "exchange|pair|make_pair|forward|declval|in_place|in_place_type|index_sequence": "utility map",
  "sort|stable_sort|any_of|all_of|none_of|find_if|find|count_if|count|transform|fill|fill_n|copy|copy_n": "algorithm",
  "min|max|clamp|min_element|max_element|minmax_element|lower_bound|upper_bound|reverse|rotate|unique": "algorithm",
  "remove_if|replace_if|equal|nth_element|generate|for_each|shuffle|is_sorted|set_difference|search": "algorithm",
  "adjacent_find|mismatch": "algorithm",
  "accumulate|iota|inner_product|reduce|gcd|lcm|partial_sum": "numeric",
  "sqrt|abs|pow|exp|log|log2|log10|sin|cos|tan|asin|acos|atan|atan2|floor|ceil|round|lround|llround": "cmath",
  "isfinite|isnan|isinf|hypot|fmod|nan|cbrt|signbit|nextafter|ldexp|frexp|trunc|expm1|log1p": "cmath",
  numeric_limits: "limits",
  numbers: "numbers",
  "bit_cast|bit_ceil|bit_width|popcount|endian|has_single_bit": "bit",
  "from_chars|to_chars": "charconv",
  "errc|error_code|error_category": "system_error filesystem charconv",
  "memcpy|memcmp|memset|strlen|strcmp|strerror|strstr|strchr|memchr": "cstring",
  "tolower|toupper|isdigit|isalpha|isspace|isalnum": "cctype",
  "getenv|strtod|strtol|exit|abort|malloc|free|system|atoi": "cstdlib",
  "snprintf|fprintf|printf|fopen|fclose|fwrite|fputs|puts|rename|remove|FILE|vsnprintf": "cstdio",
  "cout|cerr|clog|cin": "iostream",
  "endl|flush": "iostream ostream",
  "ifstream|ofstream|fstream": "fstream",
  "ostringstream|istringstream|stringstream": "sstream",
  "setw|setprecision|setfill": "iomanip",
  filesystem: "filesystem",
  chrono: "chrono",
  "thread|this_thread|jthread": "thread",
  "stop_token|stop_source": "stop_token thread",
  "mutex|lock_guard|unique_lock|scoped_lock|once_flag|call_once": "mutex",
  "condition_variable|condition_variable_any": "condition_variable",
  "future|async|promise|launch|future_status": "future",
  "atomic|atomic_flag|memory_order_relaxed": "atomic",
  "exception|current_exception|exception_ptr|rethrow_exception|terminate": "exception",
  "runtime_error|logic_error|invalid_argument|out_of_range": "stdexcept",
  initializer_list: "initializer_list",
  "regex|smatch|regex_match|regex_search": "regex",
  complex: "complex",
  "mt19937|mt19937_64|uniform_real_distribution|uniform_int_distribution|normal_distribution": "random",
  "back_inserter|advance|distance|next|prev|ssize|istreambuf_iterator|make_move_iterator": "iterator",
  "is_same_v|decay_t|is_integral_v|conditional_t|remove_cvref_t|enable_if_t|is_constant_evaluated|invoke_result_t":
    "type_traits",
  "signal|raise": "csignal",
  "time|time_t|tm|gmtime|strftime|clock": "ctime",
  "bad_alloc|nothrow": "new",
};
const declaredBy = new Map(
  Object.entries(headers).flatMap(([names, of]) => names.split("|").map((name) => [name, of.split(" ")])),
);
function* sources(folder) {
  for (const entry of readdirSync(join(root, folder), { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory() && entry.name !== "node_modules") yield* sources(path);
    else if (/\.(h|cpp)$/.test(entry.name)) yield path;
  }
}

const read = new Map();
/// The headers in angle brackets that a file includes, itself or through our own headers.
function reachable(path, seen = new Set()) {
  if (seen.has(path)) return new Set();
  seen.add(path);
  const all = new Set();
  for (const [, standard, own] of text(path).matchAll(/^\s*#\s*include\s+(?:<([^>]+)>|"([^"]+)")/gm)) {
    if (standard) all.add(standard);
    const found = own && [own, join(dirname(path), own)].find((candidate) => text(candidate) !== null);
    if (found) for (const header of reachable(found, seen)) all.add(header);
  }
  return all;
}
function text(path) {
  if (!read.has(path)) {
    try {
      read.set(path, readFileSync(join(root, path), "utf8"));
    } catch {
      read.set(path, null);
    }
  }
  return read.get(path);
}

/// The code without comments and the insides of strings.
const code = (source) =>
  source.replace(/R"(\w*)\([\s\S]*?\)\1"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])'|\/\/.*|\/\*[\s\S]*?\*\//g, (found) =>
    found[0] === "/" ? "" : '""',
  );

function missing(source, has) {
  const text = code(source);
  const names = new Set([...text.matchAll(/\bstd::(\w+)/g)].map(([, name]) => name));
  const found = [...names]
    .filter((name) => declaredBy.has(name) && !declaredBy.get(name).some((header) => has.has(header)))
    .map((name) => `std::${name} needs <${declaredBy.get(name)[0]}>`);
  const libraries = ["glm", "nlohmann"].filter((library) => new RegExp(`\\b${library}::`).test(text));
  for (const library of libraries)
    if (![...has].some((header) => header.startsWith(`${library}/`))) found.push(`${library}:: needs <${library}/...>`);
  return found;
}

test("a name of a library comes from a header that is included for it, not from another's insides", () => {
  const found = [];
  for (const folder of ["server", "tests"])
    for (const path of sources(folder))
      for (const what of missing(text(path), reachable(path))) found.push(`${path}: ${what}`);
  assert.deepEqual(found, []);
});

const definedType =
  /\b(?:struct|class|enum(?: class)?|using) (?:\[\[\w+\]\] |alignas\(\w+\) )?(\w+)(?: final)?(?=[ :\n][^;]*?\{| =)/g;
// Functions of one word share their names with variables and members.
const declaredFunction = /^(?!using|return|#)[\w:<>*&, [\]]+[ *&]([a-z]+_\w*[a-z0-9])\(/gm;

/// The types and the functions that our headers declare, and the headers that do.
function ourNames() {
  const declaredIn = new Map();
  for (const folder of ["server", "tests"])
    for (const path of sources(folder))
      if (path.endsWith(".h"))
        for (const pattern of [definedType, declaredFunction])
          for (const [, name] of code(text(path)).matchAll(pattern))
            declaredIn.set(name, [...(declaredIn.get(name) ?? []), path]);
  return declaredIn;
}

/// Paths of all files that a file includes, itself or through others, and its own.
function included(path, seen = new Set()) {
  if (seen.has(path)) return seen;
  seen.add(path);
  for (const [, own] of text(path).matchAll(/^\s*#\s*include\s+"([^"]+)"/gm)) {
    const found = [own, join(dirname(path), own)].find((candidate) => text(candidate) !== null);
    if (found) included(found, seen);
  }
  return seen;
}

const peers = "tests/bench/peers/"; // they mean other libraries' types

/// Names of ours that a source uses and neither includes nor declares; but not those of namespace elements, whose laws
/// are shared with the shaders.
function unreachable(source, files, names) {
  const text = code(source);
  const used = text.match(/(?<![.\w]|->|\b(?:elements|std)::)(?:[A-Z]\w+|[a-z]+_\w*[a-z0-9](?=\())/g);
  const declared = new Set(
    [/\b(?:struct|class|enum class|using|typename) (?:\w+::)*(\w+)/g, /(?<!\breturn)[\w>&*\]] [*&]?(\w+)(?: =|\()/g]
      .flatMap((pattern) => [...text.matchAll(pattern)])
      .map(([, name]) => name),
  );
  return [...new Set(used)].filter(
    (name) => names.has(name) && !declared.has(name) && !names.get(name).some((path) => files.has(path)),
  );
}

test("a name of our own comes from a header that is included for it, not for another source", () => {
  const names = ourNames();
  assert.ok(names.size > 500, `${names.size}`);
  const found = [];
  for (const folder of ["server", "tests"])
    for (const path of sources(folder))
      for (const name of path.startsWith(peers) ? [] : unreachable(text(path), included(path), names))
        found.push(`${path}: ${name} needs "${names.get(name)[0]}"`);
  assert.deepEqual(found, []);
});

test("a test includes Catch by tests/catch.h, which serves both its versions", () => {
  const found = [...sources("tests")].filter(
    (path) => !/^tests\/catch(_main)?\./.test(path) && /#\s*include\s+<catch2\//.test(text(path)),
  );
  assert.deepEqual(found, []);
});

test("the check sees a missing header and none in comments and strings", () => {
  assert.deepEqual(missing('std::uint8_t a;  // std::vector\nauto b = "std::map";', new Set(["cctype"])), [
    "std::uint8_t needs <cstdint>",
  ]);
  assert.deepEqual(missing("std::uint8_t a;", new Set(["cstdint"])), []);
  const names = new Map([
    ["Scene", ["server/model/scene.h"]],
    ["read_scene", ["server/model/scene.h"]],
  ]);
  assert.deepEqual(unreachable("void f(const Scene&) { x::read_scene(); }", new Set(), names), ["Scene", "read_scene"]);
  assert.deepEqual(unreachable("struct Scene;\nvoid f(const Scene&);", new Set(), names), []);
  assert.deepEqual(unreachable("void f(const Scene&);", new Set(["server/model/scene.h"]), names), []);
});
