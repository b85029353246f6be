// Plays a texture that is dropped on the page, and draws its spectrum and the sound's spectrum.

import { HtexNode, followPointer, open, prepare } from "./htex/index.js";

const find = (selector) => document.querySelector(selector);
const surface = find("#surface");
const models = find("#model");
const loudness = find("#loudness");

let context, analyser, texture, node, unfollow;

function failed(error) {
  find("#error").textContent = error?.message ?? "";
}

/** Opens a file and plays its best representation. */
async function load(file) {
  failed(null);
  try {
    context ??= new AudioContext();
    await context.resume();
    await prepare(context);
    texture = await open(await file.arrayBuffer());
    models.replaceChildren(...texture.models.map((id) => new Option(id.split(".").pop(), id)));
    models.disabled = false;
    await play();
    surface.textContent = `${texture.name}: press and move`;
  } catch (error) {
    failed(error);
  }
}

async function play() {
  node?.stop();
  unfollow?.();
  node = new HtexNode(context, texture, { model: models.value });
  node.addEventListener("error", ({ error }) => failed(error));
  loud = node.gain.value;
  setLoudness();
  analyser ??= new AnalyserNode(context, { fftSize: 8192, smoothingTimeConstant: 0.8 });
  node.connect(analyser).connect(context.destination);
  unfollow = followPointer(surface, ({ speed, force, position }) => {
    node.speed.value = speed;
    node.force.value = force;
    node.position = position;
    find("#speed").textContent = speed.toFixed(0);
    find("#force").textContent = force.toFixed(2);
    felt = speed > 0 && force > 0 ? { speed, force } : felt;
  });
  await node.ready;
  surface.dataset.ready = "";
}

/** Gain of -20 dB RMS, and the last motion with contact. */
let loud = 1;
let felt = null;

function setLoudness() {
  if (node) node.gain.value = loud * 10 ** ((Number(loudness.value) + 14) / 20);
}

const [LOW_HZ, HIGH_HZ] = [20, 1000];

/** Draws both spectra, dB over a logarithmic frequency, each relative to its largest value. */
function draw() {
  requestAnimationFrame(draw);
  if (!node) return;
  const canvas = find("#spectrum");
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  canvas.width = width * devicePixelRatio;
  canvas.height = height * devicePixelRatio;
  const pen = canvas.getContext("2d");
  pen.scale(devicePixelRatio, devicePixelRatio);
  const color = getComputedStyle(document.body).color;
  const x = (hz) => (width * Math.log(hz / LOW_HZ)) / Math.log(HIGH_HZ / LOW_HZ);
  const y = (db) => height - 24 - ((height - 32) * Math.max(db + 50, 0)) / 50;
  pen.fillStyle = color;
  pen.font = "12px system-ui";
  for (const hz of [20, 50, 100, 200, 500]) pen.fillText(`${hz} Hz`, x(hz) + 2, height - 6);
  const line = (frequencies, decibels, style) => {
    pen.strokeStyle = style;
    pen.lineWidth = 2;
    pen.beginPath();
    frequencies.forEach((hz, i) => pen.lineTo(x(hz), y(decibels[i])));
    pen.stroke();
  };
  const heard = new Float32Array(analyser.frequencyBinCount);
  analyser.getFloatFrequencyData(heard);
  const step = context.sampleRate / analyser.fftSize;
  const bins = [...heard.keys()].filter((k) => k * step >= LOW_HZ && k * step <= HIGH_HZ);
  const loudest = Math.max(...bins.map((k) => heard[k]));
  if (loudest > -100) line(bins.map((k) => k * step), bins.map((k) => heard[k] - loudest), "#27a9");
  if (felt) line(...model(), "#c60");
  const samples = new Float32Array(2048);
  analyser.getFloatTimeDomainData(samples);
  const rms = Math.hypot(...samples) / Math.sqrt(samples.length);
  const level = find("#level");
  level.dataset.rms = rms;
  level.textContent = rms > 1e-5 ? `${(20 * Math.log10(rms)).toFixed(0)} dB of full scale` : "silent";
}

/** The texture's spectrum at the last motion: frequencies, and dB relative to its largest magnitude. */
function model() {
  const frequencies = Array.from({ length: 200 }, (_, i) => LOW_HZ * (HIGH_HZ / LOW_HZ) ** (i / 199));
  const magnitudes = texture.spectrum(frequencies, { model: models.value, at: felt });
  const largest = Math.max(...magnitudes, 1e-30);
  return [frequencies, [...magnitudes].map((m) => 20 * Math.log10(m / largest + 1e-6))];
}

find("input[type=file]").addEventListener("change", ({ target }) => target.files[0] && load(target.files[0]));
models.addEventListener("change", () => play().catch(failed));
loudness.addEventListener("input", setLoudness);
for (const name of ["dragover", "dragleave", "drop"]) {
  surface.addEventListener(name, (event) => {
    event.preventDefault();
    surface.classList.toggle("over", name === "dragover");
    if (name === "drop" && event.dataTransfer.files[0]) load(event.dataTransfer.files[0]);
  });
}
requestAnimationFrame(draw);
