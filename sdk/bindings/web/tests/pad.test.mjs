// Gamepads in Node.js: the messages that their actuators receive.

import assert from "node:assert/strict";
import path from "node:path";
import test from "node:test";
import { setTimeout as wait } from "node:timers/promises";
import { pathToFileURL } from "node:url";

import { HTEX_PACKAGE, bytes } from "./fixtures.mjs";

const { dualRumble, open, playOnPad } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));

/** A gamepad that records the messages that it receives. */
function pad(more = {}) {
  const told = [];
  const vibrationActuator = {
    playEffect: async (type, effect) => void told.push({ type, at: performance.now(), ...effect }),
    ...more,
  };
  return { vibrationActuator, told };
}

const near = (a, b) => Math.abs(a - b) < 1e-12;

test("strengths are the same as from the devices in Rust", () => {
  // `two_motors` and `Scale::strength` of htex_dsp::reduced.
  const cases = [
    [{ level: 0.5, centroid: 240 }, 1, 0.25, 0.25],
    [{ level: 0.5, centroid: 30 }, 1, 0.5, 0],
    [{ level: 0.5, centroid: 700 }, 1, 0, 0.5],
    [{ level: 0.5, centroid: 60 }, 3, 1, 0],
    [{ level: 0.1, centroid: 150 }, 3, 0.3 * 0.75, 0.3 * 0.25],
    [{ level: NaN, centroid: NaN }, 3, 0, 0],
  ];
  for (const [envelope, gain, large, small] of cases) {
    const { strongMagnitude, weakMagnitude, duration } = dualRumble(envelope, { gain });
    assert.ok(near(strongMagnitude, large) && near(weakMagnitude, small) && duration === 100, JSON.stringify(envelope));
  }
  assert.throws(() => dualRumble({ level: 1, centroid: 1 }, { strenght: 1 }), { name: "HtexError", code: "invalid-argument" });
});

test("a texture is two strengths every 50 ms, and rest at the end", async () => {
  const texture = await open(await bytes("vinyl.htex"));
  const { vibrationActuator, told } = pad();
  const player = playOnPad({ vibrationActuator }, texture, { model: "ar" });
  assert.equal(player.way, "dual-rumble");
  await wait(120);
  assert.ok(told.length >= 1 && told.every((effect) => effect.strongMagnitude + effect.weakMagnitude === 0), "a finger at rest");
  player.setMotion(80, 0.5);
  await wait(400);
  const playing = told.slice(-4);
  // An RMS of 0.1 at the first condition gives a strength of 0.3.
  for (const { type, strongMagnitude, weakMagnitude, duration } of playing) {
    assert.equal(type, "dual-rumble");
    const strength = strongMagnitude + weakMagnitude;
    assert.ok(strength > 0.1 && strength < 0.6 && weakMagnitude > 0, `${strength}`);
    assert.ok(duration > 50, "it lasts until the next one");
  }
  await player.stop();
  const { strongMagnitude, weakMagnitude } = told.at(-1);
  assert.deepEqual([strongMagnitude, weakMagnitude], [0, 0]);
  const count = told.length;
  await wait(120);
  assert.equal(told.length, count);
  player.setMotion(80, 0.5);
});

test("a gamepad that fails ends the player", async () => {
  const texture = await open(await bytes("vinyl.htex"));
  let resets = 0;
  const lost = pad({ playEffect: () => Promise.reject(new Error("it is gone")), reset: async () => void (resets += 1) });
  const player = playOnPad(lost, texture, { motion: { speed: 80, force: 0.5 } });
  await assert.rejects(player.ended, { name: "HtexError", code: "io", message: /it is gone/ });
  assert.equal(resets, 1);
  assert.throws(() => playOnPad({}, texture), { code: "unsupported" });
  assert.throws(() => playOnPad(lost, {}), { code: "invalid-argument" });
  assert.throws(() => playOnPad(lost, texture, { rate: 8000 }), { code: "invalid-argument" });
});

/** A stand-in for the AudioBuffer of browsers, with the parts that `playOnPad` uses. */
class Buffer {
  constructor(options) {
    Object.assign(this, options);
  }
  copyToChannel(samples) {
    this.samples = samples;
  }
}

test("a gamepad that plays samples gets the voice's samples, within full scale", async () => {
  globalThis.AudioBuffer = Buffer;
  try {
    const texture = await open(await bytes("vinyl.htex"));
    const sounds = [];
    const playPCM = async (sound) => {
      sounds.push(sound);
      await wait(5);
      return true;
    };
    const motion = { speed: 80, force: 0.5 };
    const options = { model: "ar", seed: 3, motion };
    const player = playOnPad(pad({ playPCM }), texture, { ...options, gain: 4000 });
    assert.equal(player.way, "pcm");
    await wait(100);
    await player.stop();
    assert.ok(sounds.length > 2);
    const expected = texture.voice({ ...options, rate: 8000, bands: 1 }).render(4000);
    const played = [...sounds[0].samples, ...sounds[1].samples];
    assert.ok(sounds.every(({ length, sampleRate, numberOfChannels }) => length === 2000 && sampleRate === 8000 && numberOfChannels === 1));
    assert.ok(played.every((x, n) => x === Math.fround(Math.min(Math.max(4000 * expected[n], -1), 1))));
    assert.ok(played.some((x) => Math.abs(x) === 1), "some are limited");

    // A gamepad that cannot play samples reports this, and receives strengths instead.
    const other = pad({ playPCM: async () => false });
    const rumbling = playOnPad(other, texture, options);
    await wait(200);
    assert.equal(rumbling.way, "dual-rumble");
    await rumbling.stop();
    assert.ok(other.told.length > 1);
  } finally {
    delete globalThis.AudioBuffer;
  }
});
