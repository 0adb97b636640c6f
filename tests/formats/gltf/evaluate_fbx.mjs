// Plays an FBX file in three.js: node evaluate_fbx.mjs clip.fbx frame_time frames
// Prints JSON: the bones depth first, and for each frame their places in the world and their rotations (xyzw).
import { readFileSync } from "node:fs";

globalThis.self = globalThis; // three looks for it
globalThis.window = globalThis;
const three = await import("three");
const { FBXLoader } = await import("three/examples/jsm/loaders/FBXLoader.js");

const [path, frameTime, frames] = [process.argv[2], Number(process.argv[3]), Number(process.argv[4])];
const file = readFileSync(path);
const scene = new FBXLoader().parse(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength), "");
const bones = [];
scene.traverse((node) => node.isBone && bones.push(node));

const mixer = new three.AnimationMixer(scene);
for (const clip of scene.animations) {
  const action = mixer.clipAction(clip);
  action.setLoop(three.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
}
const places = [];
const rotations = [];
const place = new three.Vector3();
for (let frame = 0; frame < frames; frame++) {
  mixer.setTime(Math.fround(frame * frameTime)); // its key times are single precision
  scene.updateMatrixWorld(true);
  places.push(bones.map((bone) => bone.getWorldPosition(place).toArray()));
  rotations.push(bones.map((bone) => bone.quaternion.toArray()));
}
const clips = scene.animations.map((clip) => clip.name);
console.log(JSON.stringify({ names: bones.map((bone) => bone.name), clips, places, rotations }));
