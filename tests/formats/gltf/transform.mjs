// glTF files rewritten by glTF-Transform. Standard input: a JSON list of {path, output, how}: "resample" leaves out keys
// that the others imply, "integers" stores rotations as normalized integers, "sparse" stores only what is not zero,
// "beside" changes nothing (an output that ends in .gltf has its buffers in files beside it).
import { readFileSync } from "node:fs";
import { NodeIO } from "@gltf-transform/core";
import { KHRONOS_EXTENSIONS } from "@gltf-transform/extensions";
import { resample, sparse } from "@gltf-transform/functions";

function integers() {
  return (document) => {
    for (const animation of document.getRoot().listAnimations()) {
      for (const channel of animation.listChannels()) {
        const output = channel.getSampler().getOutput();
        if (channel.getTargetPath() !== "rotation" || output.getNormalized()) continue;
        output.setArray(Int16Array.from(output.getArray(), (x) => Math.round(x * 32767))).setNormalized(true);
      }
    }
  };
}

const ways = { resample: () => resample({ tolerance: 1e-6 }), integers, sparse, beside: () => () => {} };
const io = new NodeIO().registerExtensions(KHRONOS_EXTENSIONS);
for (const { path, output, how } of JSON.parse(readFileSync(0, "utf8"))) {
  const document = await io.read(path);
  await document.transform(ways[how]());
  await io.write(output, document);
}
process.stdout.write("[]");
