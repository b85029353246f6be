// "Feel it on": other outputs than the loudspeaker, each with what it cannot do.

import { useEffect, useRef, useState } from "preact/hooks";

import { feelOn, gamepadThere, hasMotor, outputs, startFeeling, type Feel } from "../feel.ts";
import { canChooseOutput, sendTo } from "../engine.ts";
import { fail, say } from "../state.ts";
import { Icon } from "./icons.tsx";

interface Way {
  readonly id: Feel;
  readonly name: string;
  readonly limit: string;
  /** Whether it can be chosen now. */
  readonly there: () => boolean;
}

/** What a way needs that can still be connected. */
const ABSENT = "No gamepad is connected.";

const SOUND: Way = { id: "none", name: "Sound only", limit: "Loudspeakers and headphones play what a finger would feel.", there: () => true };
const GAMEPAD: Way = {
  id: "gamepad",
  name: "Gamepad",
  limit: "Two motors follow the level and the pitch. They cannot play the texture's frequencies, and they react about 50 ms late.",
  there: gamepadThere,
};
const PHONE: Way = {
  id: "phone",
  name: "This phone's vibration",
  limit: "The motor is either on or off, and it has one frequency of its own. The stronger the texture, the longer the pulses.",
  there: () => true,
};

const ways = () => (hasMotor() ? [SOUND, GAMEPAD, PHONE] : [SOUND, GAMEPAD]);

export function FeelOn() {
  const [isOpen, setOpen] = useState(false);
  const menu = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!isOpen) return;
    const outside = (event: Event) => !(event.target instanceof Node && menu.current?.contains(event.target)) && setOpen(false);
    const escape = (event: KeyboardEvent) => event.key === "Escape" && setOpen(false);
    document.addEventListener("pointerdown", outside);
    document.addEventListener("keydown", escape);
    return () => {
      document.removeEventListener("pointerdown", outside);
      document.removeEventListener("keydown", escape);
    };
  }, [isOpen]);
  const choose = (id: string) => sendTo(id).then(() => say("The volume is now 0, for the new output. Raise it slowly.", "plain"), fail);
  return (
    <div class="menu" ref={menu}>
      <button class="toggle" aria-expanded={isOpen} onClick={() => (setOpen(!isOpen), void outputs.refresh())}>
        <Icon name="feel" /> <span class="wide">Feel it on</span>
      </button>
      {isOpen && (
        <div class="menu-sheet" role="group" aria-label="Feel it on">
          {ways().map(({ id, name, limit, there }) => (
            <button key={id} class="menu-item" aria-pressed={feelOn.value === id} disabled={!there()} onClick={() => startFeeling(id)}>
              <b>{name}</b>
              <small>{there() ? limit : `${limit} ${ABSENT}`}</small>
            </button>
          ))}
          {canChooseOutput() ? (
            <label class="menu-item">
              <b>Another output, such as a shaker on an amplifier</b>
              <small>It gets the sound unchanged, without calibration and without the safety limits of the htex command. The volume starts at 0.</small>
              <select onChange={(event) => choose(event.currentTarget.value)}>
                <option value="">The system's output</option>
                {outputs.list.value.map(({ id, name }) => (
                  <option key={id} value={id}>
                    {name}
                  </option>
                ))}
              </select>
            </label>
          ) : (
            <p class="menu-item">
              <small>This browser cannot choose an output. Choose it in the system's settings.</small>
            </p>
          )}
        </div>
      )}
    </div>
  );
}
