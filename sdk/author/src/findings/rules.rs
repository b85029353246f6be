//! Every rule that a recording is held to, in one table.

use htex_format::Rule;

/// The rule of a code, such as `RECORDING_CLIPPED`; none when no rule has it.
pub fn explain(code: &str) -> Option<&'static Rule> {
    RULES.iter().find(|rule| rule.code == code)
}

htex_format::rule_table! {
    RECORDING_UNREADABLE Error:
        "The file cannot be read as a recording.",
        "It is neither a table of numbers with a known lateral force, nor a WAV or NPY file of one to three channels.",
        "Correct it at the line the message names, or say with `--map` and `--rate` what the columns hold.";
    RECORDING_UNUSABLE Error:
        "No texture spectrum can be taken of the recording.",
        "It is shorter than a segment of 0.2 s, sampled below 60 Hz, or holds no sweep that can be read.",
        "Record for 10 s at 2 kHz or more, or choose other segments (`--segments`, `--from`, `--to`).";
    RECORDING_CLOCK_GAP Warning:
        "Samples are missing: the time column has gaps.",
        "The samples beside a gap are taken as neighbours, which makes a step in the signal.",
        "Cut the recording at the gap (`--from`, `--to`), or record without losing samples.";
    RECORDING_CLOCK_JITTER Warning:
        "The time column is uneven.",
        "The rate is the number of steps over the whole span of time. If the samples were really taken at \
         these times, and not only stamped so, lines are smeared in the spectrum.",
        "Give the true rate with `--rate`, or record with a clocked converter.";
    RECORDING_COARSE Warning:
        "The lateral force takes fewer than 16 different values.",
        "The spectrum shows the steps of the converter, not the texture.",
        "Raise the gain before the converter, or write the column with more digits.";
    RECORDING_CLIPPED Error:
        "The lateral force is cut off at the highest or the lowest value of its range.",
        "Where the sensor or the converter ends, the texture is not recorded, and the corners of the signal \
         add frequencies that are not the texture's.",
        "Record again with a larger range or a lower gain.";
    RECORDING_STUCK Error:
        "A sensor holds one value while the finger slides.",
        "A finger on a surface gives no constant force: the sensor, its cable or the logger stood still.",
        "Cut the stretch away (`--from`, `--to`), or record again.";
    RECORDING_SILENT Warning:
        "The lateral force stays at one value near zero for a second or more.",
        "The finger was lifted, or the sensor gave nothing. Windows over such a stretch weaken the spectrum.",
        "Cut the stretch away (`--from`, `--to`), or leave a dead axis out of the map.";
    RECORDING_SPIKE Warning:
        "Single samples of the lateral force stand out of all others.",
        "A spike of interference or a lost bit has energy at all frequencies and can outweigh the texture of \
         its segment.",
        "Cut it away (`--from`, `--to`), repair the samples, or record again.";
    RECORDING_FORCE_OUTLIER Warning:
        "Single samples of the normal force stand out of all others.",
        "No finger presses so hard for so short a time. The condition is the median, which they do not move; \
         a mean would follow them.",
        "Repair the samples, or give the force with `--force`.";
    RECORDING_FRICTION_IMPLAUSIBLE Error:
        "The lateral force is more than ten times the normal force.",
        "No finger has such a friction; one of the two columns is in another unit or is another quantity.",
        "Correct the scale of the column with `--map`.";
    RECORDING_SPEED_ZERO Error:
        "The finger stands still throughout, by its speed or position.",
        "A texture is felt by sliding, and the condition would be a speed of 0.",
        "Leave the column out, give the speed with `--speed`, or repair the tracker.";
    RECORDING_SPEED_IMPLAUSIBLE Warning:
        "The speed is no hand's.",
        "Hands explore at 1 to 2000 mm/s. A speed column in m/s that is taken as mm/s is 1000 times too low.",
        "Give the factor to mm/s with `--map speed=COLUMN:1000`, or name the unit in the column (`speed_m_s`).";
    RECORDING_SWEEPS_CUT_OFF Info:
        "Sweeps that the beginning or the end of the recording cuts off are left out.",
        "Where such a sweep began or would have ended is unknown, so its middle is too; what is taken for its \
         middle may lie where the finger starts or stops.",
        "Nothing, or start and end the recording between two sweeps.";
    RECORDING_READ_IN_WINDOWS Info:
        "The recording is read in windows, as its sweeps would leave most of it unread.",
        "One segment of 0.2 s in the middle of a sweep stands for 2 s of sliding at most. Where this leaves more \
         than half of the sliding unread, windows over the whole recording average more of it.",
        "Nothing; `--segments sweeps` reads the middles of the sweeps alone, `--from` and `--to` choose a range.";
    RECORDING_OFF_TARGET Warning:
        "Segments are left out, as their speed or force is not what was asked for.",
        "With a target given and the motion known, a segment counts if the motion stays within 10 % of the \
         target over the segment. The paper discarded and repeated such recordings.",
        "Record again nearer to the target, or give the speed and force that were recorded.";
    RECORDING_UNSTEADY Warning:
        "Speed or force leaves its own median by more than 10 %.",
        "The spectrum is then one of several conditions. Without a target nothing is left out for it.",
        "Record more steadily, cut a steady part out (`--from`, `--to`), or give a target with `--at`.";
    RECORDING_UNEVEN Warning:
        "A few segments are much louder than the others.",
        "They lie 12 dB or more above the median of all segments and make the average. Knocks and spikes do \
         this; so do windows over a recording that is mostly rest.",
        "Look at the seconds that the message names (`htex process --svg`), and choose a range by `--from` and `--to`.";
    RECORDING_NOTED Info:
        "Something had to be assumed, or limits what the recording can say.",
        "Units that no column names, columns that are not used, a band that ends below 1000 Hz.",
        "Name the columns with their units, or map them (`--map`); record at 2 kHz or more.";
}
