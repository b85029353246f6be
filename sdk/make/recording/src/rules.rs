//! The table of all rules for recordings.

htex_base::finding::rule_table! {
    RECORDING_UNREADABLE Error ("map", "rate", "quantity"):
        "The file cannot be read as a recording.",
        "It is neither a table of numbers with a lateral force, nor a WAV or NPY file of one to three channels.",
        "Correct it at the line in the message, or describe the columns by a column map and the sample rate.";
    RECORDING_UNUSABLE Error ("segments", "from", "to"):
        "No texture spectrum can be computed from the recording.",
        "It is shorter than a segment of 0.2 s, sampled below 60 Hz, or has no complete sweep.",
        "Record for 10 s at 2 kHz or more, or choose other segments or another part of the recording.";
    RECORDING_CLOCK_GAP Warning ("from", "to"):
        "Samples are missing: the time column has gaps.",
        "The samples on both sides of a gap are treated as neighbours, which causes a step in the signal.",
        "Cut the recording at the gap, or record without losing samples.";
    RECORDING_CLOCK_JITTER Warning ("rate"):
        "The time column is uneven.",
        "The rate is the number of steps over the total time. If the samples were really taken at \
         these times, and not only stamped with them, lines in the spectrum are smeared.",
        "Give the true sample rate, or record with a hardware-clocked converter.";
    RECORDING_COARSE Warning:
        "The lateral force has fewer than 16 different values.",
        "The spectrum shows the steps of the converter, not the texture.",
        "Raise the gain before the converter, or write the column with more digits.";
    RECORDING_CLIPPED Error:
        "The lateral force is clipped at the highest or the lowest value of its range.",
        "Beyond the range of the sensor or converter the texture is not recorded, and the corners of the signal \
         add frequencies that the texture does not have.",
        "Record again with a larger range or a lower gain.";
    RECORDING_STUCK Error ("from", "to"):
        "A sensor holds one value while the finger slides.",
        "The force of a sliding finger is never constant: the sensor, its cable or the logger failed.",
        "Leave the stretch out, or record again.";
    RECORDING_SILENT Warning ("from", "to", "map"):
        "The lateral force stays at one value near zero for a second or more.",
        "The finger was lifted, or the sensor had no signal. Windows over such a stretch lower the spectrum.",
        "Leave the stretch out, or remove a dead axis from the column map.";
    RECORDING_SPIKE Warning ("from", "to"):
        "Single samples of the lateral force are outliers.",
        "A spike of interference or a bit error has energy at all frequencies and can exceed the texture in \
         its segment. Many small spikes raise the whole spectrum.",
        "Leave it out, repair the samples, or record again.";
    RECORDING_RAMP Error ("map"):
        "The lateral force is a straight line.",
        "The friction of a sliding finger is never a line. The column is a time, a counter or a position, or the sensor drifts. The spectrum then shows only \
         what leaks from the line.",
        "Name the column of the lateral force in the column map, or repair the sensor.";
    RECORDING_ALTERNATES Error ("map"):
        "The lateral force alternates from sample to sample.",
        "Several channels in one column, or a fault of the converter, repeat every two, three or four samples. The spectrum shows the repetition \
         and not the texture.",
        "Give each channel its own column, or record again.";
    RECORDING_BELOW_BAND Error ("map", "quantity"):
        "What the spectrum shows leaks from frequencies below the band.",
        "A drift, a position or a normal force changes slowly and has no texture from 20 Hz on. Segments of 0.2 s cannot separate such a signal \
         from the lowest frequencies of the band, and the fit would play that leakage.",
        "Check the sensor, and name the column of the lateral force in the column map.";
    RECORDING_ABOVE_BAND Warning ("map", "rate"):
        "The signal above the band is at least 30 dB stronger than the signal in it.",
        "The sensor or its filter passes next to nothing between 20 and 1000 Hz, or the stated sample rate is too high. The fit plays the noise of the converter.",
        "Check the sensor and its filter, and give the true sample rate.";
    RECORDING_FORCE_OUTLIER Warning ("force"):
        "Single samples of the normal force are outliers.",
        "A finger cannot press so hard for so short a time. The condition is the median, which outliers do not change; \
         a mean would change.",
        "Repair the samples, or give the normal force.";
    RECORDING_FRICTION_IMPLAUSIBLE Error ("map"):
        "The lateral force is more than ten times the normal force.",
        "Fingers do not reach this coefficient of friction; one of the two columns has another unit or quantity.",
        "Correct the scale of the column in the column map.";
    RECORDING_FRICTION_COEFFICIENT Warning ("map"):
        "The lateral force does not change with the normal force, as a friction coefficient does.",
        "A coefficient of friction, which has no unit, is read as newtons: its texture is too strong or too weak by the normal force, \
         and does not grow with it.",
        "If it is a coefficient, multiply it by the normal force in the column map, as in lateral=friction*force,normal=force. If it is a force, check the \
         sensor of the normal force.";
    RECORDING_SPEED_ZERO Error ("speed"):
        "According to its speed or position, the finger never moves.",
        "A texture is recorded while sliding, and the condition would have a speed of 0.",
        "Remove the column, give the scanning speed, or repair the tracker.";
    RECORDING_SPEED_IMPLAUSIBLE Warning ("map"):
        "The speed is outside the range of a hand.",
        "Hands explore at 1 to 2000 mm/s. A speed column in m/s that is read as mm/s is 1000 times too low.",
        "Give the factor to mm/s in the column map, as in speed=COLUMN:1000, or name the unit in the column (`speed_m_s`).";
    RECORDING_SWEEPS_CUT_OFF Info:
        "Sweeps cut off by the beginning or the end of the recording are left out.",
        "The start or end of such a sweep is unknown, and so is its middle. The middle of the recorded part may be \
         where the finger starts or stops.",
        "No action is needed; or start and end the recording between two sweeps.";
    RECORDING_READ_IN_WINDOWS Info ("segments sweeps"):
        "The recording is read in windows, because the middles of its sweeps would cover too little of it.",
        "One segment of 0.2 s in the middle of a sweep represents at most 2 s of sliding. Where this leaves more \
         than half of the sliding unused, windows over the whole recording average more of it.",
        "No action is needed; the choice of sweeps as segments reads only their middles, and a range leaves parts out.";
    RECORDING_OFF_TARGET Warning ("speed", "force", "at"):
        "Segments are left out because their speed or force differs from the target.",
        "With a target given and the motion known, a segment is used if the motion stays within 10 % of the \
         target over the segment. The paper discarded and repeated such recordings.",
        "Record again closer to the target, or give the speed and force that were recorded.";
    RECORDING_UNSTEADY Warning ("from", "to", "at"):
        "Speed or force differs from its own median by more than 10 %.",
        "The spectrum then mixes several conditions. Without a target no segment is left out.",
        "Record more steadily, choose a steady part, or give a target.";
    RECORDING_UNEVEN Warning ("from", "to"):
        "A few segments are much louder than the others.",
        "They are 12 dB or more above the median of all segments and dominate the average. Causes are knocks, spikes, \
         and windows over a recording that is mostly rest.",
        "Check the times in the message, and choose a range.";
    RECORDING_LEVELS_DIFFER Warning ("at", "scale"):
        "Recordings of one condition differ in level by more than 8 dB.",
        "Recordings at one speed and force are averaged, and the loudest decide the result. One of them has another gain, unit, speed or force, or a fault.",
        "Give each recording its own speed and force, correct the scale, or leave the recording out.";
    GRID_NOT_BETTER Warning ("grid"):
        "One condition for all motions predicts what was left out better than the grid of conditions does.",
        "Each quarter of the recordings is left out in turn and predicted from the rest. A grid that is worse than the mean of \
         all its windows has too few windows for its conditions, or the texture changes more from stroke to stroke than with speed and force.",
        "Fit without a grid, record for longer, or choose fewer lines.";
    RECORDING_NOTED Info:
        "The reader made an assumption, or the recording is limited.",
        "Examples are columns without a unit, columns that are not used, a band that ends below 1000 Hz.",
        "Name the columns with their units, or map them; record at 2 kHz or more.";
}
