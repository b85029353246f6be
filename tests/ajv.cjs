// Holds documents to schemas by Ajv: `node ajv.cjs QUESTIONS.json`, made by tests/schemas.rs. Prints the
// names of the documents that are refused. An unknown keyword or format in a schema is an error.
const fs = require("fs");
const Ajv = require("ajv/dist/2020");

const { schemas, documents } = JSON.parse(fs.readFileSync(process.argv[2], "utf8"));
const ajv = new Ajv({ schemas, logger: false });
for (const schema of schemas) ajv.getSchema(schema.$id);
const refused = documents.filter(({ schema, document }) => !ajv.getSchema(schema)(document));
console.log(JSON.stringify(refused.map(({ name }) => name)));
