//! Every rule that a scene is held to, in one table.

use htex_format::Rule;

/// The rule of a code, such as `REGION_OVERLAP`; none when no rule has it.
pub fn explain(code: &str) -> Option<&'static Rule> {
    RULES.iter().find(|rule| rule.code == code)
}

htex_format::rule_table! {
    SCENE_FILE_TOO_LARGE Error:
        "The scene file is larger than the limit.",
        "A reader caps what it takes from a file it does not trust, before it reads it.",
        "Keep long motions in a trace; a scene of a hundred surfaces has a few kilobytes.";
    SCENE_JSON_TOO_DEEP Error:
        "The scene nests deeper than the limit.",
        "Deep nesting exhausts a parser's stack, and no scene needs it.",
        "Take out what does not belong there.";
    SCENE_JSON_SYNTAX Error:
        "The scene is not JSON.",
        "It must be one JSON object in UTF-8 (RFC 8259), without a byte order mark.",
        "Correct it at the place the message names.";
    SCENE_VERSION_MISSING Error:
        "The scene has no `htex_scene`.",
        "Without the version a reader would have to guess what the rest means.",
        "Add `\"htex_scene\": \"1.0\"`.";
    SCENE_VERSION_INVALID Error:
        "`htex_scene` is not a version.",
        "It is a string of two whole numbers without leading zeros, `MAJOR.MINOR`.",
        "Write `\"htex_scene\": \"1.0\"`.";
    SCENE_VERSION_UNSUPPORTED Error:
        "The scene is of another major version.",
        "Another major version may mean other things by the same words.",
        "Play it with a program of that version, or write it anew as version 1.";
    SCENE_VERSION_NEWER Info:
        "The scene is of a newer minor version.",
        "It can be played; what is new in it is left alone.",
        "Update the program to play all of it.";
    EFFECT_UNKNOWN Error:
        "`effects` names an effect that there is not.",
        "A misspelt effect would be left to the planner, and the scene would feel otherwise than meant.",
        "Correct its name; the message lists them all.";
    SCENE_JSON_TYPE Error:
        "A key is missing, stands twice, or has a value of the wrong type.",
        "The scene does not follow `schemas/scene-1.json`.",
        "Correct it at the place the pointer names.";
    SCENE_UNKNOWN_KEY Error:
        "A key is not of this version.",
        "What it was to change stays as it is, and the scene would feel otherwise than meant.",
        "Correct its spelling, or take it out.";
    SURFACES_EMPTY Error:
        "There is no surface.",
        "There is nothing to feel.",
        "Add a surface with an asset.";
    SURFACES_TOO_MANY Error:
        "There are more surfaces than the limit.",
        "Each surface is held ready while the scene plays.",
        "Split the scene, or merge surfaces of the same asset.";
    SURFACE_GAIN_INVALID Error:
        "The gain of a surface is out of range.",
        "It is a factor from 0 to 1000; one below 0 would turn the force round.",
        "Write 1 to play the surface as it was recorded.";
    REPRESENTATION_NAME_EMPTY Error:
        "A surface's representation has no name.",
        "It is a model's id or short name, or `auto`.",
        "Name a model, or leave the key out.";
    REGION_INVALID Error:
        "A region is empty, upside down or beyond all bounds.",
        "Both pairs run from a lower to a higher number of millimetres, within a kilometre.",
        "Write `\"x_mm\": [from, to]` with from below to, and `y_mm` alike.";
    REGION_OVERLAP Error:
        "Two surfaces of one layer lie on the same place.",
        "A player could not tell which of them the finger feels.",
        "Move one of them, or give one a higher `layer`.";
    REGION_UNKNOWN_POSITION Error:
        "Nobody knows where the finger is.",
        "There are several surfaces, or one in a region, and the constant motion does not say where it starts.",
        "Add `from_mm`, or leave one surface without a region.";
    MOTION_INVALID Error:
        "A number of the motion is out of range.",
        "Speed is 0 to 10000 mm/s and force 0 to 1000 N; places lie within a kilometre.",
        "Correct it; a direction is given by `direction_deg`, not by a sign.";
    DURATION_INVALID Error:
        "The duration is not a length of time.",
        "It is more than 0 and at most 1e9 seconds.",
        "Correct it, or leave it out: a trace has its own, and other motions go on until they are stopped.";
    BUDGET_INVALID Error:
        "A budget is not a positive number.",
        "Nothing takes no time, and no representation is without error.",
        "Correct it, or leave it out.";
    DEVICE_FIELD_INVALID Error:
        "A number of `device` is out of range.",
        "It would make silence, or more than any device takes.",
        "Correct it to what the message allows, or leave it out.";
    ASSET_MISSING Error:
        "A surface's asset is not there.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or put the asset there.";
    ASSET_INVALID Error:
        "A surface's asset cannot be used.",
        "It is not a valid asset, or brings a model that cannot be loaded.",
        "Look at it with `htex validate`.";
    REPRESENTATION_MISSING Error:
        "The asset does not have the representation that the scene asks for.",
        "Another model would feel otherwise than meant.",
        "Name one that it has (`htex info`), or `auto`.";
    REPRESENTATION_UNPLAYABLE Error:
        "The asset's representation cannot be played here.",
        "Its model is not installed, is of another version, or refuses the parameters.",
        "Install the model as a plugin (`--plugin`), or name another representation.";
    TRACE_MISSING Error:
        "The trace is not there.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or put the trace there.";
    TRACE_INVALID Error:
        "The trace cannot be read.",
        "It is a CSV with the columns `t_s`, `x_mm`, `y_mm`, `force_n`, and a time that ascends.",
        "Correct it at the line the message names.";
    TRACE_ASSUMED Warning:
        "Something about the trace had to be assumed.",
        "A column without a unit, or one that is not used, may be another than meant.",
        "Name the columns `t_s`, `x_mm`, `y_mm`, `force_n`, `speed_mm_s`.";
    DURATION_BEYOND_TRACE Warning:
        "The scene lasts longer than its trace.",
        "Behind its last row the finger does not touch.",
        "Shorten `duration_s`, or leave it out.";
    MOTION_BEYOND_RECORDED Warning:
        "A texture is played as at another motion than the finger's.",
        "The motion lies beyond the speeds and forces it was recorded at, or beyond what it can be scaled to from one.",
        "Move within what was recorded (`htex info`), or record the texture at such a motion too.";
    RESPONSE_MISSING Error:
        "The response is not there.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or put the response there.";
    RESPONSE_INVALID Error:
        "The response cannot be read.",
        "It is a CSV with the columns `frequency_hz`, ascending, and `magnitude`, not negative and not all 0.",
        "Correct it at the line the message names.";
    RESPONSE_RAISED Warning:
        "The compensation of the response raises a part of the band by more than 10 dB.",
        "The device plays that part so much stronger than the texture is: it may reach its limit there, and errors of the response count as much.",
        "Check the response there, or hold the compensation back by a lower `response_depth_db`.";
    DEVICE_UNKNOWN Error:
        "There is no such device adapter.",
        "What the samples mean depends on the device.",
        "Correct the name; `htex device list` shows what there is.";
    DEVICE_PATH_UNSAFE Error:
        "A setting of the scene names a driver.",
        "A scene may come from anyone: playing it must not load code.",
        "Give the setting on the command line (`--set`).";
    DEVICE_PATH_UNUSED Warning:
        "A setting of the scene names a file to write.",
        "A scene may come from anyone: what is written where, a person says.",
        "Name the file by `-o`, or by the setting on the command line (`--set`); take it out of the scene.";
    DEVICE_HARDWARE Warning:
        "The scene says what the hardware is, or asks for more than a limit allows.",
        "A wrong gain or limit puts hundreds of volts more at a finger. What describes the hardware comes from a \
         profile or from the command line; a scene can only ask for a lower limit or a longer ramp.",
        "Choose the profile of the rig with `--profile`; take the setting out of the scene.";
    DEVICE_SETTING Error:
        "A profile or a setting of the device cannot be used.",
        "It is not known, missing, or not a value it may have.",
        "Correct it; `htex device info` shows settings and profiles.";
    DEVICE_ABSENT Warning:
        "The device cannot be asked now.",
        "It is not connected or its driver is not installed, so what depends on it is not checked.",
        "Connect it and validate again; on another machine this may be as it should.";
    DEVICE_RATE Error:
        "The device does not run at this rate.",
        "It would play at another one, and all frequencies would be wrong.",
        "Choose one of its rates, or leave `rate_hz` out.";
    DEVICE_FIELD_UNFIT Error:
        "A key of `device` does not go with what the device takes.",
        "`gain_db` is for newtons and other quantities of touch, `drive_v` for volts at a display, `level_dbfs` and `pitch` for sound, and \
         `levels` for the last two; `reference_rms` goes with the levels `own`.",
        "Leave it out, or choose another device.";
    DEVICE_QUANTITY Error:
        "The device does not take what the assets hold, or `quantity_gain` is stated for one that does.",
        "An acceleration of 1 m/s2 is no force of 1 N: what it is to be felt as, a person must say.",
        "Choose a device or a setting that takes the assets' quantity, or state `quantity_gain`; leave it out where \
         device and assets agree, and for sound.";
    QUANTITIES_DIFFER Error:
        "The assets of a scene hold different quantities.",
        "One device plays them all, and newtons and metres cannot be compared.",
        "Use assets of one quantity, or a scene for each.";
    DEVICE_DRIVE_TOO_HIGH Error:
        "`drive_v` is above the device's limit.",
        "Voltages beyond the limit are cut off, and are not what was meant to be felt.",
        "Lower it.";
}
