// How a program plays the texture, by language.

export interface Snippet {
  readonly language: string;
  readonly text: string;
}

export function snippets(file: string, speed: number, force: number): Snippet[] {
  const [mmS, newtons] = [Math.round(speed), Number(force.toFixed(2))];
  const decimal = (x: number) => (Number.isInteger(x) ? `${x}.0` : String(x));
  return [
    {
      language: "HTML",
      text: `<div id="pad" style="height: 300px; background: #ddd"></div>
<script type="module">
  import { open, prepare, HtexNode, follow } from "./htex/index.js";

  const texture = await open("${file}");
  const context = new AudioContext();
  await prepare(context);
  const node = new HtexNode(context, texture);
  node.connect(context.destination);
  follow(document.getElementById("pad"), node);
</script>`,
    },
    {
      language: "JavaScript",
      text: `import { open } from "htex";
import { readFile } from "node:fs/promises";

const texture = await open(await readFile("${file}"));
const voice = texture.voice({ rate: 20000 });
voice.setMotion(${mmS}, ${newtons}); // mm/s, N
const samples = voice.render(20000); // one second`,
    },
    {
      language: "Python",
      text: `import htex

voice = htex.open("${file}").voice(rate_hz=20_000)
voice.set_motion(speed_mm_s=${mmS}, force_n=${newtons})
samples = voice.render(20_000)  # one second`,
    },
    {
      language: "Rust",
      text: `let texture = htex::Texture::open("${file}")?;
let mut voice = texture.voice(&htex::VoiceOptions::default())?;
let mut block = [0.0f32; 256];
voice.set_motion(htex::Motion::new(${decimal(mmS)}, ${decimal(newtons)}))?; // mm/s, N
voice.render(&mut block)?;`,
    },
    {
      language: "C",
      text: `#include <htex.h>
#include <math.h>

htex_asset asset;
htex_voice voice;
float block[64];
htex_motion motion = {sizeof motion, ${decimal(mmS)}, ${decimal(newtons)}, NAN, NAN, NAN}; /* mm/s, N */
if (htex_asset_open("${file}", NULL, &asset) != HTEX_STATUS_OK
    || htex_voice_new(asset, NULL, &voice) != HTEX_STATUS_OK
    || htex_voice_set_motion(voice, &motion) != HTEX_STATUS_OK
    || htex_voice_render(voice, block, 64) != HTEX_STATUS_OK)
    puts(htex_last_error());`,
    },
    {
      language: "C#",
      text: `using (var asset = Htex.Asset.Open("${file}"))
using (var voice = asset.Voice())
{
    var block = new float[64];
    voice.SetMotion(new Htex.Motion(${decimal(mmS)}, ${decimal(newtons)})); // mm/s, N
    voice.Render(block);
}`,
    },
  ];
}
