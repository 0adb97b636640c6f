// The Khronos validator over glTF files: their paths come as a JSON list on standard input, a JSON list of
// {errors, warnings, infos, messages} goes out.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import validator from "gltf-validator";

const reports = [];
for (const path of JSON.parse(readFileSync(0, "utf8"))) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(path)), { uri: basename(path) });
  reports.push({
    errors: issues.numErrors,
    warnings: issues.numWarnings,
    infos: issues.numInfos + issues.numHints,
    messages: issues.messages.slice(0, 5).map((issue) => `${issue.code} ${issue.pointer ?? ""}: ${issue.message}`),
  });
}
process.stdout.write(JSON.stringify(reports));
