import { useState } from "react";

import { TexturePad } from "./texture-pad";

/** Files in the folder `public`. */
const TEXTURES = ["cloth.htex", "vinyl.htex"];

export function App() {
  const [source, setSource] = useState(TEXTURES[0] ?? "");
  const [muted, setMuted] = useState(false);
  return (
    <main>
      <TexturePad source={source} muted={muted} />
      {TEXTURES.map((name) => (
        <button key={name} aria-pressed={name === source} onClick={() => setSource(name)}>
          {name}
        </button>
      ))}
      <label>
        <input type="checkbox" checked={muted} onChange={() => setMuted(!muted)} /> Haptics off
      </label>
    </main>
  );
}
