export function Vary() {
  return <section><h1>Vary</h1></section>;
}
