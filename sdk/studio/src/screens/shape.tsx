export function Shape() {
  return <section><h1>Shape</h1></section>;
}
