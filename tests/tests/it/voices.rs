//! Requirements of the voice of every model: it matches its magnitude and level, before and after
//! other parameters, alone and with others.

use crate::common::fit;
use htex_dsp::grid::level_rms;
use htex_host::{Band, LoadedModel, Registry, Stream, render_together};
use htex_tests::measure::{RATE_HZ, distance_db, measured_spectrum};
use htex_tests::smooth_spectrum;

/// Every built-in model with parameters fitted to a varied spectrum.
fn fitted() -> Vec<(LoadedModel, Vec<f64>)> {
    let band = Band::TACTILE;
    let grid = band.grid_hz();
    let ripple = |(i, m): (usize, &f64)| m * (1.0 + 0.3 * (i as f64 * 0.9).sin());
    let magnitude: Vec<f64> = smooth_spectrum(&grid).iter().enumerate().map(ripple).collect();
    let models = Registry::builtin();
    let fitted = |model: &LoadedModel| {
        (model.clone(), fit(model, band, &magnitude, (RATE_HZ, &[])).parameters)
    };
    models.models().iter().map(fitted).collect()
}

fn stream(model: &LoadedModel, parameters: &[f64], seed: u64) -> Stream {
    Stream::new(model, parameters, Band::TACTILE, RATE_HZ, seed).unwrap()
}

#[test]
fn a_minute_of_each_voice_has_its_magnitude_and_level() {
    for (model, parameters) in fitted() {
        let mut out = vec![0.0f32; 60 * RATE_HZ as usize];
        stream(&model, &parameters, 11).render(&mut out).unwrap();
        let heard = measured_spectrum(&out);
        let rms = level_rms(&heard);
        let grid = Band::TACTILE.grid_hz();
        let magnitude = model.magnitude(&parameters, Band::TACTILE, &grid).unwrap();
        let distance = distance_db(&heard, &magnitude);
        println!("{:16} RMS {rms:.4}  spectrum within {distance:.3} dB RMS", model.id());
        assert!((rms - 1.0).abs() < 0.02, "{}: RMS {rms}", model.id());
        assert!(distance < 1.0, "{}: {distance} dB", model.id());
    }
}

/// A voice that has been retuned through a hundred mixes plays each mix like a voice made for it,
/// to a ten-thousandth of its RMS. Lines are left out: sPeak's sinusoids continue with their
/// phases, and a map keeps the correction for the filters at the band's edges with which it was
/// made (0.4 % between two rows).
#[test]
fn a_retuned_voice_plays_what_one_made_so_plays() {
    const SEED: u64 = 21;
    let models = fitted();
    let (ar, usual) = &models[0];
    let of_order = |order: usize| {
        let coefficients = (0..order).map(|k| 0.25 * (-0.7f64).powi(k as i32));
        let rate_hz = usual[usual.len() - 1];
        [order as f64].into_iter().chain(coefficients).chain([rate_hz]).collect()
    };
    let pairs = models.iter().filter(|(model, _)| !model.has_lines());
    let pairs =
        pairs.map(|(model, parameters)| (model, parameters.clone(), louder_at_one_end(model)));
    // Orders that rise and fall, in direct form and as a lattice.
    let orders = [(3, 8), (5, 30)].map(|(low, high)| (ar, of_order(low), of_order(high)));
    for (model, parameters, other) in pairs.chain(orders) {
        let rate_hz = model.voice_rate_hz(&parameters, Band::TACTILE, RATE_HZ).unwrap();
        let make = |set: &[f64]| model.voice(set, Band::TACTILE, rate_hz, SEED).unwrap();
        let mut voice = make(&parameters);
        // Long enough for a change, and for the previous state of filters, to decay.
        let frames = (0.5 * rate_hz) as usize;
        let (mut retuned, mut worst) = (vec![0.0; frames], 0.0f64);
        for i in 0..100 {
            let part = 0.5 + 0.5 * (1.7 * f64::from(i)).sin();
            let mixed = model.interpolate(&[&parameters, &other], &[part, 1.0 - part]).unwrap();
            // If changes arrive during another change, the last one counts.
            voice.retune(&other).unwrap();
            voice.render(&mut retuned[..5]).unwrap();
            voice.retune(&parameters).unwrap();
            voice.retune(&mixed).unwrap();
            voice.render(&mut retuned[5..]).unwrap();
            let mut made = vec![0.0; (i as usize + 1) * frames];
            make(&mixed).render(&mut made).unwrap();
            let end = frames - frames / 10;
            let (retuned, made) = (&retuned[end..], &made[made.len() - frames + end..]);
            let power =
                |x: &mut dyn Iterator<Item = f32>| -> f64 { x.map(|x| f64::from(x).powi(2)).sum() };
            let error = power(&mut retuned.iter().zip(made).map(|(a, b)| a - b));
            worst = worst.max((error / power(&mut made.iter().copied())).sqrt());
        }
        println!("{:16} within {worst:.1e} of the RMS", model.id());
        assert!(worst < 1e-4, "{}: {worst}", model.id());
    }
}

/// Voices rendered in one call give the same bits as each alone: with any remainder in their last
/// blocks, while some of them change, and next to voices of other models.
#[test]
fn voices_together_are_voices_alone() {
    let models = fitted();
    let (ar, _) = &models[0];
    let mut sets: Vec<(&LoadedModel, Vec<f64>)> =
        models.iter().map(|(m, p)| (m, p.clone())).collect();
    // Orders and rates of filters that run side by side, with other lengths, and as a lattice.
    let orders = [6, 6, 2, 6, 9, 6, 6, 6, 6, 3, 6, 6, 20, 6, 6, 6, 6, 1, 6, 6, 6];
    let first = sets.len();
    for (i, order) in orders.into_iter().enumerate() {
        let mut set = vec![f64::from(order)];
        set.extend((0..order).map(|k| 0.25 * (-0.7f64).powi(k)));
        set.push(if i / 4 == 1 { 4_000.0 } else { 2_000.0 });
        sets.push((ar, set));
    }
    let make = |(i, (model, set)): (usize, &(&LoadedModel, Vec<f64>))| {
        let rate_hz = model.voice_rate_hz(set, Band::TACTILE, RATE_HZ).unwrap();
        model.voice(set, Band::TACTILE, rate_hz, i as u64).unwrap()
    };
    let mut alone: Vec<_> = sets.iter().enumerate().map(make).collect();
    let mut together: Vec<_> = sets.iter().enumerate().map(make).collect();
    // The last one is a sample behind the others.
    let last = sets.len() - 1;
    together[last].render(&mut [0.0]).unwrap();
    alone[last].render(&mut [0.0]).unwrap();
    for (round, frames) in [1, 256, 64, 3, 67, 200, 0, 1_000, 40, 256].into_iter().enumerate() {
        if round == 4 {
            for i in [first, first + 7] {
                let mut set = sets[i].1.clone();
                set[1] *= 0.8;
                alone[i].retune(&set).unwrap();
                together[i].retune(&set).unwrap();
            }
        }
        let mut out = vec![f32::NAN; (sets.len() + 1) * frames];
        render_together(&mut together, frames, &mut out).unwrap();
        for (i, voice) in alone.iter_mut().enumerate() {
            let mut own = vec![0.0; frames];
            voice.render(&mut own).unwrap();
            assert_eq!(own, out[i * frames..][..frames], "voice {i}, {frames} frames");
        }
        assert!(out[sets.len() * frames..].iter().all(|x| *x == 0.0));
    }
}

/// Parameters fitted to a falling spectrum with two bumps.
fn louder_at_one_end(model: &LoadedModel) -> Vec<f64> {
    let band = Band::TACTILE;
    let grid = band.grid_hz();
    let curve = |f: &f64| (-f / 90.0).exp() * (1.2 + (f / 25.0).sin());
    let magnitude: Vec<f64> = grid.iter().map(curve).collect();
    fit(model, band, &magnitude, (RATE_HZ, &[])).parameters
}

#[test]
fn a_rate_that_cannot_be_reached_is_an_error() {
    let model = Registry::builtin().find("ar").unwrap().clone();
    // White noise at 50 Hz.
    let (parameters, band) = ([0.0, 50.0], Band::from((5.0, 20.0)));
    let stream = |rate_hz: f64| Stream::new(&model, &parameters, band, rate_hz, 0);
    assert!(stream(50.0).unwrap().render(&mut [0.0; 100]).is_ok());
    let refused = stream(1e6).unwrap_err().to_string();
    assert!(refused.contains("from 50 Hz to 1000000 Hz"), "{refused}");
}

/// White noise over a band whose upper half bin lies above the Nyquist frequency. The filters at
/// the band's edges and that half bin remove 1.1 %. The voice corrects for this, and for what the
/// band's bins miss at its edges.
#[test]
fn the_level_is_that_behind_the_filters_of_the_band() {
    let model = Registry::builtin().find("ar").unwrap().clone();
    for (rate_hz, band) in
        [(2_000.0, Band::TACTILE), (4_000.0, Band::TACTILE), (2_000.0, Band::from((150.0, 700.0)))]
    {
        let mut power = 0.0;
        for seed in 0..8 {
            let stream = Stream::new(&model, &[0.0, rate_hz], band, RATE_HZ, seed);
            let mut out = vec![0.0f32; 1 << 20];
            stream.unwrap().render(&mut out).unwrap();
            let first = band.first_bin() - Band::TACTILE.first_bin();
            let read = &measured_spectrum(&out)[first..first + band.bins()];
            power += level_rms(read).powi(2) / 8.0;
        }
        // Noise with this many samples scatters by 0.1 %; from 2 kHz on, the resampler removes 0.3
        // %.
        assert!((power.sqrt() - 1.0).abs() < 6e-3, "{rate_hz} {band:?}: {}", power.sqrt());
    }
}
