// glTF-Transform's resample, asked over and over by gltf_keys.py: one JSON object a line, in and out.
// First line in: {frameTime, tracks: [{path: "rotation" | "translation", values: [...]}]}, baked, a value a frame (xyzw).
// Then lines {tolerance}; out comes {frames: [[...], ...]}, the frames that each track keeps.
import { createInterface } from "node:readline";
import { Document, Logger } from "@gltf-transform/core";
import { resample } from "@gltf-transform/functions";

function documentOf({ frameTime, tracks }) {
  const document = new Document().setLogger(new Logger(Logger.Verbosity.SILENT));
  const buffer = document.createBuffer();
  const animation = document.createAnimation();
  for (const { path, values } of tracks) {
    const size = path === "rotation" ? 4 : 3;
    const times = Float32Array.from({ length: values.length / size }, (_, frame) => frame * frameTime);
    const input = document.createAccessor().setType("SCALAR").setArray(times).setBuffer(buffer);
    const output = document.createAccessor().setType(`VEC${size}`).setArray(new Float32Array(values)).setBuffer(buffer);
    const sampler = document.createAnimationSampler().setInput(input).setOutput(output).setInterpolation("LINEAR");
    const channel = document.createAnimationChannel().setTargetNode(document.createNode()).setTargetPath(path);
    animation.addSampler(sampler).addChannel(channel.setSampler(sampler));
  }
  return document;
}

let clip;
for await (const line of createInterface({ input: process.stdin })) {
  const asked = JSON.parse(line);
  if (asked.tracks) {
    clip = asked;
    continue;
  }
  const document = documentOf(clip);
  await document.transform(resample({ tolerance: asked.tolerance, cleanup: false }));
  const samplers = document.getRoot().listAnimations()[0].listSamplers();
  const frames = samplers.map((s) => Array.from(s.getInput().getArray(), (t) => Math.round(t / clip.frameTime)));
  console.log(JSON.stringify({ frames }));
}
