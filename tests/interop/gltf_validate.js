// Validates a glTF file and prints what is wrong as JSON: {"errors":0,"warnings":0,"messages":[...]}.
// Ends with 3 where the validator is not installed.
const fs = require('fs');
let validator;
try {
  validator = require('gltf-validator');
} catch (missing) {
  process.exit(3);
}
validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then((report) => {
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(JSON.stringify({ errors: numErrors, warnings: numWarnings, messages: messages.slice(0, 5) }));
});
