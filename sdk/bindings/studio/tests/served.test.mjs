// `htex studio`: the folder, served on this machine by the command.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import test, { after, before } from "node:test";

import { HTEX_COMMAND, HTEX_STUDIO, goTo, launch, openStudio, shaping } from "./studio.mjs";

let browser, command, address;

before(async () => {
  browser = await launch();
  command = spawn(HTEX_COMMAND, ["studio", "--folder", HTEX_STUDIO, "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
  address = await new Promise((resolve, reject) => {
    command.stdout.on("data", (text) => resolve(/http:\S+\//.exec(text)[0]));
    command.on("exit", (code) => reject(new Error(`htex studio ended with ${code}`)));
  });
});

after(async () => {
  await browser?.close();
  command?.kill("SIGINT");
});

test("the command serves the studio, which shapes and plays under its policy", async () => {
  const page = await openStudio(browser, address);
  await shaping(page);
  await page.evaluate(() => htexStudio.setMacro("rougher", 0.4));
  await page.getByRole("button", { name: "Steady" }).click();
  await page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.02);
  await goTo(page, "Save");
  await page.getByText("The file passes validation").waitFor();
  assert.deepEqual(page.requests.filter((url) => !url.startsWith(address)), []);
  assert.deepEqual(page.errors, []);
});

test("Ctrl-C ends it", async () => {
  const ended = new Promise((resolve) => command.on("exit", resolve));
  command.kill("SIGINT");
  assert.equal(await ended, 0);
});
