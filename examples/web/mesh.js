// Shows a mesh whose material carries a texture, and plays it by the speed of the pointer over the surface.

import { AmbientLight, Box3, DirectionalLight, PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer } from "three";

import { HtexNode, open, prepare } from "./htex/index.js";
import { read, touched, way } from "./surface.js";

/** Seconds over which the speed is averaged, and after which a pointer that sends nothing rests. */
const AVERAGED_S = 0.03;
const RESTS_S = 0.06;
/** The force of a pointer, N: a screen tells none. */
const FORCE_N = 0.4;
const FIELD_OF_VIEW_DEG = 40;
const RADIANS_PER_PIXEL = 0.01;

const find = (selector) => document.querySelector(selector);
const view = find("#view");
const scene = new Scene();
const camera = new PerspectiveCamera(FIELD_OF_VIEW_DEG, 1, 1e-3, 1e3);
const light = new DirectionalLight("white", 2);
light.position.set(1, 2, 3);
scene.add(new AmbientLight("white", 1), light);

let renderer, context, analyser, node, surface, last, turning;
let speed = 0;

function failed(error) {
  find("#error").textContent = error?.message ?? "";
}

/** Opens a file, shows its mesh, and plays its texture. */
async function load(file) {
  failed(null);
  delete view.dataset.ready;
  try {
    context ??= new AudioContext();
    await context.resume();
    await prepare(context);
    const bytes = await file.arrayBuffer();
    const made = await read(file.name.endsWith(".gltf") ? new TextDecoder().decode(bytes) : bytes);
    const texture = await open(made.asset);
    show(made);
    await play(texture);
    find("#name").textContent = texture.name;
    view.dataset.ready = "";
  } catch (error) {
    failed(error);
  }
}

function show(made) {
  if (surface) scene.remove(surface.scene);
  surface = made;
  scene.add(surface.scene);
  const box = new Box3().setFromObject(surface.scene);
  const [center, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3()).length()];
  camera.position.copy(center).add(new Vector3(0, 0, size / (2 * Math.tan((FIELD_OF_VIEW_DEG * Math.PI) / 360))));
  camera.near = size / 100;
  camera.far = size * 100;
  camera.updateProjectionMatrix();
  camera.lookAt(center);
  last = null;
}

async function play(texture) {
  node?.stop();
  node = new HtexNode(context, texture);
  node.addEventListener("error", ({ error }) => failed(error));
  analyser ??= new AnalyserNode(context, { fftSize: 2048 });
  node.connect(analyser).connect(context.destination);
  move(0, 0);
  await node.ready;
}

function move(mm_s, force_n) {
  speed = mm_s;
  find("#speed").textContent = speed.toFixed(0);
  if (!node) return;
  node.speed.value = speed;
  node.force.value = force_n;
}

/** Where a pointer is: from -1 to 1 in both directions, up and to the right. */
function place({ clientX, clientY }) {
  const box = view.getBoundingClientRect();
  return new Vector2((2 * (clientX - box.left)) / box.width - 1, 1 - (2 * (clientY - box.top)) / box.height);
}

/** The contact at an event, in the form that `last` has. */
function contact(event) {
  const at = surface && touched(surface, place(event), camera);
  return at && { ...at, time: event.timeStamp, position: last?.position ?? 0 };
}

function down(event) {
  if (event.button !== 0) return;
  view.setPointerCapture(event.pointerId);
  last = contact(event);
  turning = last ? null : event;
  if (last) touch();
}

function moved(event) {
  if (turning && surface) {
    surface.scene.rotation.y += RADIANS_PER_PIXEL * (event.clientX - turning.clientX);
    surface.scene.rotation.x += RADIANS_PER_PIXEL * (event.clientY - turning.clientY);
    surface.scene.updateMatrixWorld();
    turning = event;
  } else if (last) {
    slide(event);
  }
}

/** Follows a pointer that is on the surface, until it leaves. */
function slide(event) {
  const next = contact(event);
  if (!next) return up();
  const seconds = (next.time - last.time) / 1e3;
  if (seconds <= 0) return;
  const mm = way(last, next);
  const weight = 1 - Math.exp(-seconds / AVERAGED_S);
  last = { ...next, position: last.position + mm };
  move(speed + weight * (mm / seconds - speed), FORCE_N);
  touch();
}

/** Shows and plays the place of the contact. */
function touch() {
  node.position = last.position;
  node.force.value = FORCE_N;
  for (const axis of ["x", "y"]) find(`#${axis}`).textContent = last[axis]?.toFixed(1) ?? "unknown";
}

function up() {
  last = turning = null;
  move(0, 0);
}

setInterval(() => {
  if (last && speed > 0 && performance.now() - last.time > 1e3 * RESTS_S) move(0, FORCE_N);
}, 1e3 * RESTS_S);

function draw() {
  requestAnimationFrame(draw);
  if (!surface) return;
  try {
    renderer ??= new WebGLRenderer({ canvas: view, antialias: true, alpha: true });
  } catch (error) {
    surface = null;
    return failed(error);
  }
  fit();
  renderer.render(scene, camera);
  tell();
}

/** Gives the picture the size of the view, where that has changed. */
function fit() {
  const [width, height] = [view.clientWidth, view.clientHeight];
  const size = renderer.getSize(new Vector2());
  if (size.x === width && size.y === height && renderer.getPixelRatio() === devicePixelRatio) return;
  renderer.setPixelRatio(devicePixelRatio);
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  camera.updateProjectionMatrix();
}

/** Tells the level of the sound. */
function tell() {
  const samples = new Float32Array(2048);
  analyser.getFloatTimeDomainData(samples);
  const rms = Math.hypot(...samples) / Math.sqrt(samples.length);
  const level = find("#level");
  level.dataset.rms = rms;
  level.textContent = rms > 1e-5 ? `${(20 * Math.log10(rms)).toFixed(0)} dB of full scale` : "silent";
}

find("input[type=file]").addEventListener("change", ({ target }) => target.files[0] && load(target.files[0]));
view.addEventListener("pointerdown", down);
view.addEventListener("pointermove", moved);
for (const name of ["pointerup", "pointercancel"]) view.addEventListener(name, up);
for (const name of ["dragover", "dragleave", "drop"]) {
  view.addEventListener(name, (event) => {
    event.preventDefault();
    view.classList.toggle("over", name === "dragover");
    if (name === "drop" && event.dataTransfer.files[0]) load(event.dataTransfer.files[0]);
  });
}
requestAnimationFrame(draw);
