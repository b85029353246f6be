import { useEffect, useRef, useState } from "react";
import { follow, HtexNode, open, prepare } from "htex";

interface Properties {
  /** Address of a `.htex` file. */
  source: string;
  /** Whether the texture is silent, e.g. because the user has turned haptics off. */
  muted?: boolean;
}

/**
 * A pad that plays a texture through the sound output while a pointer slides over it. If `source`
 * changes, the pad fades to the other texture. On a server, the pad only renders its element.
 */
export function TexturePad({ source, muted = false }: Properties) {
  const pad = useRef<HTMLDivElement>(null);
  const output = useRef<GainNode>(null);
  const player = useRef<HtexNode>(null);
  const stopFollowing = useRef<() => void>(null);
  const [busy, setBusy] = useState(true);
  const [problem, setProblem] = useState("");

  // A context for as long as the pad is on the page. React calls this before the effects below.
  useEffect(() => {
    const context = new AudioContext();
    output.current = context.createGain();
    output.current.connect(context.destination);
    return () => {
      stopFollowing.current?.();
      player.current = null;
      void context.close();
    };
  }, []);

  useEffect(() => {
    output.current?.gain.setTargetAtTime(muted ? 0 : 1, 0, 0.01);
  }, [muted]);

  useEffect(() => {
    const speaker = output.current;
    if (!speaker) return;
    let current = true;
    const play = async () => {
      const context = speaker.context as AudioContext;
      const [texture] = await Promise.all([open(source), prepare(context)]);
      // `source` has changed in the meantime, or the pad has left the page.
      if (!current) return;
      if (player.current) return player.current.load(texture);
      player.current = new HtexNode(context, texture);
      player.current.connect(speaker);
      stopFollowing.current = follow(pad.current, player.current);
      await player.current.ready;
    };
    setBusy(true);
    setProblem("");
    play()
      .catch((error: unknown) => current && setProblem(error instanceof Error ? error.message : String(error)))
      .finally(() => current && setBusy(false));
    return () => {
      current = false;
    };
  }, [source]);

  return (
    <div ref={pad} role="application" aria-label="Texture" aria-busy={busy} style={{ width: 600, height: 300, background: busy ? "#eee" : "#ddd" }}>
      {problem}
    </div>
  );
}
