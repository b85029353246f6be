// Icons, drawn with one stroke on a grid of 24.

const PATHS = {
  shelf: "M4 4h7v7H4zM13 4h7v7h-7zM4 13h7v7H4zM13 13h7v7h-7z",
  shape: "M3 17c4 0 4-11 8-11s3 8 6 8 2-3 4-3",
  mix: "M4 6c8 0 8 12 16 12M4 18c3.500 0 5.500-2.300 7-5M20 6c-3 0-5 1.500-6.500 4",
  vary: "M12 3v4M12 17v4M3 12h4M17 12h4M6 6l2.500 2.500M15.500 15.500L18 18M18 6l-2.500 2.500M8.500 15.500L6 18M12 10a2 2 0 100 4 2 2 0 000-4",
  compare: "M4 5h7v14H4zM13 5h7v14h-7zM7.500 9v6M16.500 11v2",
  record: "M3 12h2l2-6 3 12 3-9 2 6 2-3h4",
  give: "M12 15V4M8 8l4-4 4 4M5 13v6h14v-6",
  undo: "M8 5L4 9l4 4M4 9h10a5 5 0 010 10h-4",
  redo: "M16 5l4 4-4 4M20 9H10a5 5 0 000 10h4",
  sound: "M4 10v4h3l5 4V6L7 10zM16 9a4 4 0 010 6M18.500 6.500a8 8 0 010 11",
  muted: "M4 10v4h3l5 4V6L7 10zM16 10l4 4M20 10l-4 4",
  close: "M6 6l12 12M18 6L6 18",
  search: "M10.500 4a6.500 6.500 0 100 13 6.500 6.500 0 000-13M15.500 15.500L20 20",
  folder: "M3 6h6l2 2h10v11H3z",
  warn: "M12 4L3 19h18zM12 10v4M12 16.500v.5",
  play: "M8 5l11 7-11 7z",
  stop: "M6 6h12v12H6z",
  hand: "M8 12V6a1.500 1.500 0 013 0v5-7a1.500 1.500 0 013 0v7-5a1.500 1.500 0 013 0v8c0 4-2.500 6-5.500 6S7 19 5 15c-.8-1.500 1-2.500 2-1.300L8 15",
  feel: "M7 8v8M4 10v4M17 8v8M20 10v4M10 5h4v14h-4z",
  check: "M5 12l5 5 9-10",
  copy: "M4 4h11v11H4zM9 19h11V9",
  steps: "M3 6h4v12H3zM10 6h4v12h-4zM17 6h4v12h-4z",
  light: "M12 8a4 4 0 100 8 4 4 0 000-8M12 2v2.500M12 19.500V22M2 12h2.500M19.500 12H22M5 5l1.700 1.700M17.300 17.300L19 19M19 5l-1.700 1.700M6.700 17.300L5 19",
  more: "M5 12h.01M12 12h.01M19 12h.01",
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 24 24" aria-hidden="true">
      <path d={PATHS[name]} />
    </svg>
  );
}
