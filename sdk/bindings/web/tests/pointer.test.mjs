// Pointers (mouse, pen and fingers), simulated through the browser's input protocol.

import assert from "node:assert/strict";
import test, { after, before } from "node:test";

import { drag, pause, start } from "./browser.mjs";

let here;
before(async () => {
  here = await start();
});
after(() => here?.close());

/** Opens a page in which a pointer is followed over a surface. The page stores the `motions`. */
async function followed(options = "", pageOptions) {
  const made = await here.page("empty.html", pageOptions);
  await made.run(`(async () => {
    const { followPointer } = await import("/htex/index.js");
    window.motions = [];
    window.unfollow = followPointer(document.querySelector("#surface"), (motion) => window.motions.push(motion), {${options}});
  })()`);
  return made;
}

const motions = (made) => made.run("window.motions");
const fastest = (all) => Math.max(...all.map(({ speed }) => speed));

test("the mouse moves the finger", async () => {
  const made = await followed();
  await drag(made, { lift: false });
  await pause(200);
  await drag(made, { from: 450, to: 440 });
  const all = await motions(made);
  // 400 pixels are 105.8 mm.
  assert.ok(Math.abs(all.at(-1).position - 105.8) < 0.5, `${all.at(-1).position}`);
  assert.ok(fastest(all) > 50 && fastest(all) < 2000, `${fastest(all)}`);
  assert.ok(all.some(({ speed, force }) => speed === 0 && force > 0), "rests");
  assert.deepEqual({ ...all.at(-1), position: 0, x: 0, y: 0 }, { speed: 0, force: 0, position: 0, x: 0, y: 0 });
  const across = Math.max(...all.map(({ x }) => x)) - Math.min(...all.map(({ x }) => x));
  assert.ok(Math.abs(across - 105.8) < 0.5 && all.every(({ y }) => Math.abs(y - all[0].y) < 0.01), `${across}`);
  // A mouse reports no force.
  assert.deepEqual([...new Set(all.map(({ force }) => force))].sort(), [0, 0.4]);
  await made.close();
});

test("the other buttons of a mouse move nothing", async () => {
  const made = await followed();
  for (const [button, buttons] of [["right", 2], ["middle", 4]]) {
    await made.input.send("Input.dispatchMouseEvent", { type: "mousePressed", x: 50, y: 50, button, buttons, clickCount: 1 });
    await made.input.send("Input.dispatchMouseEvent", { type: "mouseMoved", x: 250, y: 50, button, buttons });
    await made.input.send("Input.dispatchMouseEvent", { type: "mouseReleased", x: 250, y: 50, button, clickCount: 1 });
  }
  assert.deepEqual(await motions(made), []);
  await made.close();
});

test("of two fingers the first one counts", async () => {
  const made = await followed("defaultForce: 0.3", { hasTouch: true });
  const touch = (type, ...points) => made.input.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([id, x, y]) => ({ id, x, y })) });
  await touch("touchStart", [1, 50, 100]);
  await touch("touchStart", [1, 50, 100], [2, 550, 250]);
  for (let x = 50; x <= 150; x += 5) {
    await touch("touchMove", [1, x, 100], [2, 600 - x, 250]);
    await pause(10);
  }
  const held = (await motions(made)).at(-1);
  await touch("touchEnd");
  const all = await motions(made);
  // Only the first finger moves 100 pixels: 26.5 mm.
  assert.ok(Math.abs(all.at(-1).position - 26.5) < 0.5, `${all.at(-1).position}`);
  assert.ok(fastest(all) < 400, `${fastest(all)}`);
  assert.equal(held.force, 0.3);
  assert.equal(all.at(-1).force, 0);
  await made.close();
});

test("a finger neither scrolls nor is taken away, until following ends", async () => {
  const made = await followed("", { hasTouch: true });
  await made.run("void (document.body.style.height = '5000px')");
  const points = (y) => ({ touchPoints: [{ id: 1, x: 100, y }] });
  const stroke = async () => {
    await made.input.send("Input.dispatchTouchEvent", { type: "touchStart", ...points(280) });
    for (let y = 280; y >= 40; y -= 10) {
      await made.input.send("Input.dispatchTouchEvent", { type: "touchMove", ...points(y) });
      await pause(10);
    }
    await made.input.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
    await pause(200);
    return made.run("window.scrollY");
  };
  assert.equal(await stroke(), 0);
  // 240 pixels are 63.5 mm.
  assert.ok(Math.abs((await motions(made)).at(-1).position - 63.5) < 0.5);
  await made.run("window.unfollow()");
  assert.equal(await made.run("document.querySelector('#surface').style.touchAction"), "");
  assert.ok((await stroke()) > 0);
  await made.close();
});

test("a pen that measures has its force, and a device that does not has the default", async () => {
  const made = await followed();
  const pen = (type, x, force) =>
    made.input.send("Input.dispatchMouseEvent", { type, x, y: 50, button: "left", buttons: 1, clickCount: 1, pointerType: "pen", force });
  await pen("mousePressed", 50, 0.25);
  await pen("mouseMoved", 60, 0.75);
  await pen("mouseMoved", 70, 0.5);
  await pen("mouseReleased", 70, 0);
  const forces = (await motions(made)).map(({ force }) => force.toFixed(2));
  // A motion may be reported twice.
  assert.deepEqual(forces.filter((force, i) => force !== forces[i - 1]), ["0.20", "0.60", "0.40", "0.00"]);
  await made.close();
});

test("what can be mistaken is an error", async () => {
  const made = await followed();
  const error = (code) => made.run(`(async () => { const htex = await import("/htex/index.js"); try { ${code} } catch (e) { return e.name + " " + e.message; } })()`);
  assert.match(await error("htex.followPointer(document.querySelector('#none'), () => {})"), /HtexError.*querySelector/);
  assert.match(await error("htex.followPointer(document.body, () => {}, { mmPerPixle: 1 })"), /HtexError.*mmPerPixel/);
  assert.match(await error("htex.follow(document.body, {})"), /HtexError.*HtexNode/);
  await made.close();
});
