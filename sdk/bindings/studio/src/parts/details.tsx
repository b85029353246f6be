// The exact words of an error, for those who want to report it.

export function Details({ text }: { text: string }) {
  return (
    <details class="details">
      <summary>Details</summary>
      {text}
    </details>
  );
}
