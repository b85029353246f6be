export function Record() {
  return <section><h1>Record</h1></section>;
}
