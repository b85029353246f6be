export function Give() {
  return <section><h1>Give</h1></section>;
}
