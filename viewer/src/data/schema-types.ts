// TypeScript types from the JSON Schema of documents: as much of JSON Schema as that one uses.

export interface Schema {
  title?: string;
  description?: string;
  type?: string | string[];
  properties?: Record<string, Schema>;
  required?: string[];
  items?: Schema;
  minItems?: number;
  maxItems?: number;
  additionalProperties?: Schema | boolean;
  enum?: string[];
  const?: string;
  oneOf?: Schema[];
  anyOf?: Schema[];
  $ref?: string;
  $defs?: Record<string, Schema>;
}

const primitives: Record<string, string> = { integer: "number", number: "number", string: "string", boolean: "boolean", null: "null" };

function comment(schema: Schema, indent: string): string {
  if (!schema.description) return "";
  return `${indent}/** ${schema.description.replace(/\s*\n\s*/g, " ")} */\n`;
}

function union(types: string[]): string {
  return [...new Set(types)].join(" | ");
}

function arrayOf(schema: Schema): string {
  const item = schema.items ? typeOf(schema.items) : "unknown";
  const { minItems, maxItems } = schema;
  if (minItems !== undefined && minItems === maxItems && minItems <= 8) return `[${Array(minItems).fill(item).join(", ")}]`;
  return /[|{]/.test(item) ? `(${item})[]` : `${item}[]`;
}

function objectOf(schema: Schema, indent = ""): string {
  if (!schema.properties) {
    const values = schema.additionalProperties;
    return `Record<string, ${typeof values === "object" ? typeOf(values) : "unknown"}>`;
  }
  const required = new Set(schema.required ?? []);
  const field = ([name, of]: [string, Schema]) => `${comment(of, `${indent}  `)}${indent}  ${name}${required.has(name) ? "" : "?"}: ${typeOf(of, `${indent}  `)};\n`;
  return `{\n${Object.entries(schema.properties).map(field).join("")}${indent}}`;
}

function typeOf(schema: Schema, indent = ""): string {
  if (schema.$ref) return schema.$ref.split("/").at(-1) ?? "unknown";
  if (schema.const !== undefined) return JSON.stringify(schema.const);
  if (schema.enum) return union(schema.enum.map((value) => JSON.stringify(value)));
  const choices = schema.oneOf ?? schema.anyOf;
  if (choices) return union(choices.map((choice) => typeOf(choice, indent)));
  const one = (type: string): string => {
    if (type === "array") return arrayOf(schema);
    if (type === "object") return objectOf(schema, indent);
    return primitives[type] ?? "unknown";
  };
  return union([schema.type ?? "object"].flat().map(one));
}

/** The text of a module with a type for each definition. */
export function typesOf(schema: Schema): string {
  const all: [string, Schema][] = [[schema.title ?? "Document", schema], ...Object.entries(schema.$defs ?? {})];
  const declared = all.map(([name, of]) => {
    const type = typeOf(of);
    return `${comment(of, "")}export ${of.properties ? `interface ${name} ${type}` : `type ${name} = ${type};`}\n`;
  });
  return `// Made from spec/view.schema.json by \`npm run types\`; a test compares it.\n\n${declared.join("\n")}`;
}
