// The address at which a phone can open the studio. The address of this page may exist only on this device.

import { computed, signal } from "@preact/signals";

import { keepSetting, setting } from "./store.ts";

/** Characters that fit into the largest QR code, of version 40 with the least correction of errors. */
export const MOST_CHARACTERS = 2953;

const STORED = "phone";

/** The address that the user has entered. */
export const entered = signal("");
let isRead = false;

/** Reads the address of last time; once. */
export async function readEntered() {
  if (isRead) return;
  isRead = true;
  const found = await setting(STORED);
  if (found && !entered.peek()) entered.value = found;
}

const isWeb = ({ protocol }: URL) => protocol === "https:" || protocol === "http:";

/** Whether a host is the device that asks for it. */
const isOwn = ({ hostname }: URL) => /(^|\.)localhost\.?$/.test(hostname) || /^(127\.|0\.0\.0\.0$|\[::1?\]$)/.test(hostname);

/** Why a phone cannot open this page; null if it can. */
export function obstacle() {
  const page = new URL(location.href);
  if (!isWeb(page)) return "This page is a file on this device, so a phone cannot open it.";
  return isOwn(page) ? `This page is at ${page.host}, an address that exists only on this device. A phone cannot open it.` : null;
}

/** What is wrong with the entered address; null if nothing is. */
export const problem = computed(() => {
  const text = entered.value.trim();
  if (!/^https?:\/\//i.test(text) || !URL.canParse(text)) return "Enter a whole address that begins with https://";
  return isOwn(new URL(text)) ? "On the phone, this address is the phone itself. Enter the address of a server." : null;
});

/** Whether browsers give the page at the entered address what it needs. Over http they do so only on this device. */
export const isSecure = computed(() => /^https:/i.test(entered.value.trim()));

/** Stores the address if a phone can open it, or if there is none any more. */
export async function keepEntered() {
  const text = entered.peek().trim();
  if (text === "" || !problem.peek()) await keepSetting(STORED, text);
}

/** The page that the phone opens; null if there is none yet. */
export function pageForPhone() {
  if (!obstacle()) return location.href;
  return problem.value ? null : new URL(entered.value.trim()).href;
}
