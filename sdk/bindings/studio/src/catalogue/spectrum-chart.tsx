// The spectrum of a texture at one motion, with axes.

import { FINE_HZ } from "../look/spectrum-line.ts";
import { isNarrow } from "../theme.ts";

/** Size of the chart, and the room for its numbers, in units of the picture. On a phone, it is narrower, so that its numbers can be read. */
const [WIDE, NARROW, HEIGHT, LEFT, BOTTOM] = [640, 350, 220, 48, 30];
const RIGHT = 18;
/** Range that is drawn below the largest value, dB, and the distance of its lines. */
const [RANGE_DB, STEP_DB] = [50, 10];
const MARKS_HZ = [20, 50, 100, 200, 500, 1000];

const [LOW, HIGH] = [FINE_HZ[0] ?? 20, FINE_HZ.at(-1) ?? 1000];

export function SpectrumChart({ magnitudes, unit, speed, force }: { magnitudes: Float64Array; unit: string; speed: number; force: number }) {
  const width = isNarrow.value ? NARROW : WIDE;
  const across = (hz: number) => LEFT + ((width - LEFT - RIGHT) * Math.log(hz / LOW)) / Math.log(HIGH / LOW);
  const decibels = Array.from(magnitudes, (magnitude) => 20 * Math.log10(Math.max(magnitude, 1e-12)));
  const top = Math.ceil(Math.max(...decibels) / STEP_DB) * STEP_DB;
  const down = (db: number) => 8 + ((HEIGHT - BOTTOM - 8) * Math.min(Math.max((top - db) / RANGE_DB, 0), 1));
  const path = `M${decibels.map((db, i) => `${across(FINE_HZ[i] ?? LOW).toFixed(1)} ${down(db).toFixed(1)}`).join("L")}`;
  const strongest = FINE_HZ[decibels.indexOf(Math.max(...decibels))] ?? LOW;
  const caption = `Spectrum at ${speed.toFixed(0)} mm/s and ${force.toFixed(2)} N, dB relative to 1 ${unit}, over frequency in Hz`;
  return (
    <figure class="spectrum-chart">
      <svg viewBox={`0 0 ${width} ${HEIGHT}`} role="img" aria-label={`${caption}. It is strongest at ${strongest.toFixed(0)} Hz.`}>
        {Array.from({ length: RANGE_DB / STEP_DB + 1 }, (_, i) => top - i * STEP_DB).map((db) => (
          <g key={db}>
            <line x1={LEFT} x2={width - RIGHT} y1={down(db)} y2={down(db)} />
            <text x={LEFT - 6} y={down(db) + 4} text-anchor="end">
              {db}
            </text>
          </g>
        ))}
        {MARKS_HZ.map((hz) => (
          <text key={hz} x={across(hz)} y={HEIGHT - 8} text-anchor="middle">
            {hz}
          </text>
        ))}
        <path d={path} />
      </svg>
      <figcaption class="soft small">{caption}</figcaption>
    </figure>
  );
}
