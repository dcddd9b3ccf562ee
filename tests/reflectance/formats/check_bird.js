// node check_bird.js SCHEMA_FOLDER FILE...: exit 0 when ajv's 2020 build finds every file valid, 1 when not, 2 when there is
// no ajv. ajv is what `npm ci` puts beside this file, or in $GONIO_NODE_MODULES.
const fs = require('fs');
const path = require('path');

function from_npm(name) {
  const folder = process.env.GONIO_NODE_MODULES;
  return require(folder ? path.join(folder, name) : name);
}

let Ajv, formats;
try {
  Ajv = from_npm('ajv/dist/2020').default;
  formats = from_npm('ajv-formats').default;
} catch (problem) {
  console.log(`no ajv: npm ci --prefix ${__dirname}`);
  process.exit(2);
}
const ajv = new Ajv({strict: false, allErrors: true});
formats(ajv);
const [folder, ...files] = process.argv.slice(2);
let whole;
for (const name of fs.readdirSync(folder).filter(name => name.endsWith('.json'))) {
  let schema;
  try {
    schema = JSON.parse(fs.readFileSync(path.join(folder, name)));
  } catch (problem) {
    continue;  // one that the others do not refer to is no JSON
  }
  ajv.addSchema(schema);
  if (name.startsWith('brdf_')) whole = schema.$id;
}
const valid = ajv.getSchema(whole);
let exit = 0;
for (const file of files) {
  if (valid(JSON.parse(fs.readFileSync(file)))) continue;
  console.log(file, JSON.stringify(valid.errors.slice(0, 5)));
  exit = 1;
}
process.exit(exit);
