// How a web page plays the texture. The documentation shows how programs in other languages do.

export function webPage(file: string): string {
  return `<div id="pad" style="height: 300px; background: #ddd"></div>
<script type="module">
  import { open, prepare, HtexNode, follow } from "./htex/index.js";

  const texture = await open("${file}");
  const context = new AudioContext();
  await prepare(context);
  const node = new HtexNode(context, texture);
  node.connect(context.destination);
  follow(document.getElementById("pad"), node);
</script>`;
}
