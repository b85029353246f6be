// A recording's signal over time, with the stretches that are read.

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Processed } from "htex";

import { scheme } from "../theme.ts";

const HEIGHT = 190;

/** Shades what is read. */
function readParts({ read_s }: Processed): uPlot.Plugin {
  const draw = (plot: uPlot) => {
    const { ctx } = plot;
    ctx.save();
    ctx.fillStyle = getComputedStyle(plot.root).getPropertyValue("--accent-soft");
    for (const [from, to] of read_s) {
      const [left, right] = [plot.valToPos(from, "x", true), plot.valToPos(to, "x", true)];
      ctx.fillRect(left, plot.bbox.top, Math.max(right - left, 1), plot.bbox.height);
    }
    ctx.restore();
  };
  return { hooks: { drawClear: draw } };
}

export function Waveform({ processed }: { processed: Processed }) {
  const place = useRef<HTMLDivElement>(null);
  const colours = scheme.value;
  useEffect(() => {
    const element = place.current;
    const { picture } = processed;
    const signal = picture.signals["signal"];
    if (!element || !signal) return;
    const style = getComputedStyle(element);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    const seconds = Array.from({ length: signal.least.length }, (_, i) => picture.from_s + (i + 0.5) * picture.step_s);
    const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: `12px ${style.fontFamily}` };
    const line = { stroke: colour("--accent"), width: 1, points: { show: false } };
    const plot = new uPlot(
      {
        width: element.clientWidth,
        height: HEIGHT,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false } },
        axes: [axis, { ...axis, size: 64 }],
        series: [{}, line, line],
        bands: [{ series: [2, 1], fill: colour("--accent") }],
        plugins: [readParts(processed)],
      },
      [seconds, [...signal.least], [...signal.greatest]],
      element,
    );
    const observer = new ResizeObserver(() => plot.setSize({ width: element.clientWidth, height: HEIGHT }));
    observer.observe(element);
    return () => {
      observer.disconnect();
      plot.destroy();
    };
  }, [processed, colours]);
  return <div ref={place} class="waveform" role="img" aria-label={`Signal of ${processed.duration_s.toFixed(1)} s. The ${processed.read_s.length} stretches that are read are shaded.`} />;
}
