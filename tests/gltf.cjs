// Validates glTF files by the validator of Khronos: `node gltf.cjs FILE …`. Prints its reports.
const fs = require("fs");
const validator = require("gltf-validator");

const report = (file) => validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 0 });
Promise.all(process.argv.slice(2).map(report)).then((reports) => console.log(JSON.stringify(reports)));
