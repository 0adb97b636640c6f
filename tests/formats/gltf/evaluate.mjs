// What three.js plays of glTF files. Standard input: a JSON list of {path, animation, times, output}, the animation by
// name (null: the first), times in seconds. Each `output` gets float64 numbers: at every time, for every joint of the
// first skin, its place in the world (x y z, metres) and its rotation against its parent (x y z w). Standard output: a
// JSON list of {joints, bones, figures, animations}: names of joints and animations, how many joints are bones, and
// how many skinned meshes there are.
import { readFileSync, writeFileSync } from "node:fs";

globalThis.self = globalThis; // the loader looks for its browser there
globalThis.ProgressEvent ??= Event; // and tells with it how far the buffer inside a .gltf is
const { AnimationMixer } = await import("three");
const { GLTFLoader } = await import("three/examples/jsm/loaders/GLTFLoader.js");

async function evaluate({ path, animation, times, output }) {
  const bytes = readFileSync(path);
  const data = path.endsWith(".gltf") ? bytes.toString("utf8") : new Uint8Array(bytes).buffer;
  const gltf = await new GLTFLoader().parseAsync(data, "");
  const nodes = gltf.parser.json.skins[0].joints;
  const joints = await Promise.all(nodes.map((node) => gltf.parser.getDependency("node", node)));
  const clip = gltf.animations.find((each) => animation === null || each.name === animation);
  const mixer = new AnimationMixer(gltf.scene);
  const action = clip === undefined ? null : mixer.clipAction(clip).play();
  const numbers = new Float64Array(times.length * joints.length * 7);
  let place = 0;
  for (const time of times) {
    if (action !== null) action.time = time;
    mixer.update(0);
    gltf.scene.updateMatrixWorld(true);
    for (const joint of joints) {
      numbers.set(joint.matrixWorld.elements.slice(12, 15), place);
      numbers.set(joint.quaternion.toArray(), place + 3);
      place += 7;
    }
  }
  writeFileSync(output, numbers);
  let figures = 0;
  gltf.scene.traverse((object) => (figures += object.isSkinnedMesh ? 1 : 0));
  return {
    joints: nodes.map((node) => gltf.parser.json.nodes[node].name),
    bones: joints.filter((joint) => joint.isBone).length,
    figures,
    animations: gltf.animations.map((each) => each.name),
  };
}

const told = [];
for (const job of JSON.parse(readFileSync(0, "utf8"))) told.push(await evaluate(job));
process.stdout.write(JSON.stringify(told));
