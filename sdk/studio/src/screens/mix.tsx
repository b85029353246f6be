export function Mix() {
  return <section><h1>Mix</h1></section>;
}
