//! Renders four voices at the same time, which is faster than rendering one voice after another.
//!
//! The operations and their order are the same as for one voice, so the samples are bit-identical.

use htex_dsp::all_pole::{AllPoles, GROUP};
use htex_dsp::noise::GaussianNoise;
use htex_dsp::pipeline::Pipelines;
use htex_dsp::quad::{Quad, VOICES};
use htex_model::Voice;

use crate::AutoregressionVoice;

/// Number of groups of samples per step.
const BLOCK: usize = 64;
/// Smallest number of groups for which rendering side by side is faster.
const LEAST: usize = 16;

/// Renders four voices, each into its own row.
pub(crate) fn render(voices: &mut [&mut AutoregressionVoice; VOICES], rows: [&mut [f32]; VOICES]) {
    let frames = rows[0].len();
    let [first, others @ ..] = &*voices;
    // Renders the rest of the current group first, and then whole groups.
    let head = (GROUP - first.taken()).min(frames);
    let body = (frames - head) / GROUP * GROUP;
    let alike = others.iter().all(|other| other.taken() == first.taken());
    if !alike || body < LEAST * GROUP || !voices.iter().all(|voice| voice.is_steady()) {
        return alone(voices, rows);
    }
    let parts = rows.map(|row| {
        let (head, rest) = row.split_at_mut(head);
        let (body, tail) = rest.split_at_mut(body);
        [head, body, tail]
    });
    let [[h0, b0, t0], [h1, b1, t1], [h2, b2, t2], [h3, b3, t3]] = parts;
    alone(voices, [h0, h1, h2, h3]);
    let mut body = [b0, b1, b2, b3];
    if !groups(voices, &mut body) {
        alone(voices, body);
    }
    alone(voices, [t0, t1, t2, t3]);
}

fn alone(voices: &mut [&mut AutoregressionVoice; VOICES], rows: [&mut [f32]; VOICES]) {
    for (voice, row) in voices.iter_mut().zip(rows) {
        voice.render(row);
    }
}

/// Renders whole groups of each voice. Returns false, without an effect, if the filters cannot run
/// side by side.
fn groups(
    voices: &mut [&mut AutoregressionVoice; VOICES],
    rows: &mut [&mut [f32]; VOICES],
) -> bool {
    let [a, b, c, d] = voices;
    let gains = Quad([a.gain(), b.gain(), c.gain(), d.gain()]);
    let filters =
        [&mut a.filter.poles, &mut b.filter.poles, &mut c.filter.poles, &mut d.filter.poles];
    let edges = [&mut a.edges, &mut b.edges, &mut c.edges, &mut d.edges];
    // This comes before any noise is drawn, so that returning false has no effect on the voices.
    let (Some(mut filters), Some(mut edges)) = (AllPoles::new(filters), Pipelines::new(edges))
    else {
        return false;
    };
    // The output buffer is first used for the noise.
    let [r0, r1, r2, r3] = rows;
    GaussianNoise::fill_both([&mut a.noise, &mut b.noise], [r0, r1]);
    GaussianNoise::fill_both([&mut c.noise, &mut d.noise], [r2, r3]);
    let frames = rows[0].len();
    let mut room = [Quad([0.0; VOICES]); BLOCK * GROUP];
    for start in (0..frames).step_by(room.len()) {
        let block = &mut room[..(frames - start).min(BLOCK * GROUP)];
        let [a, b, c, d] = rows.each_mut().map(|row| &mut row[start..start + block.len()]);
        Quad::gather([a, b, c, d], gains, block);
        filters.process(block.as_chunks_mut().0);
        edges.process(block.as_chunks_mut().0);
        Quad::scatter(block, [a, b, c, d]);
    }
    true
}
