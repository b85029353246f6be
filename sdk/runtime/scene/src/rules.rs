//! All rules for scenes, in one table.
//!
//! Some rules are stricter for a scene than for an asset. In an asset, a misspelt key has no
//! effect, so the reader only warns. In a scene, a misspelt key would change what is felt, so the
//! reader refuses the scene. Because a scene may come from an untrusted source, it must not name a
//! driver, and it must not name an output file outside its own folder.

htex_base::finding::rule_table! {
    SCENE_FILE_TOO_LARGE Error:
        "The scene file is larger than the limit.",
        "A reader limits the size of untrusted files before it reads them.",
        "Keep long motions in a trace; a scene with a hundred surfaces takes a few kilobytes.";
    SCENE_JSON_TOO_DEEP Error:
        "The scene nests deeper than the limit.",
        "Deep nesting exhausts a parser's stack, and no scene needs it.",
        "Remove the unneeded levels.";
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
        "The same keys may have other meanings in another major version.",
        "Play it with a program for that version, or rewrite it as version 1.";
    SCENE_VERSION_NEWER Info:
        "The scene is of a newer minor version.",
        "It can be played; keys of the newer version are ignored.",
        "Update the program to use them.";
    EFFECT_UNKNOWN Error:
        "`effects` names an unknown effect.",
        "A misspelt effect would be ignored, and the scene would not feel as intended.",
        "Correct its name; the message lists them all.";
    SCENE_JSON_TYPE Error:
        "A key is missing, is duplicated, or has a value of the wrong type.",
        "The scene does not follow `schemas/scene-1.json`.",
        "Correct it at the place the pointer names.";
    SCENE_UNKNOWN_KEY Error:
        "A key is unknown in this version.",
        "An unknown key has no effect, and the scene would not feel as intended.",
        "Correct its spelling, or remove it.";
    SURFACES_EMPTY Error:
        "There is no surface.",
        "There is nothing to feel.",
        "Add a surface with an asset.";
    SURFACES_TOO_MANY Error:
        "There are more surfaces than the limit.",
        "Each surface takes memory and time while the scene plays.",
        "Split the scene, or merge surfaces of the same asset.";
    SURFACE_GAIN_INVALID Error:
        "The gain of a surface is out of range.",
        "It is a factor from 0 to 1000; a negative one would reverse the force.",
        "Write 1 to play the surface as it was recorded.";
    REPRESENTATION_NAME_EMPTY Error:
        "A surface's representation has no name.",
        "It is a model's id or short name, or `auto`.",
        "Name a model, or leave the key out.";
    REGION_INVALID Error:
        "A region is empty, reversed or out of range.",
        "Both pairs are a lower and a higher coordinate in millimetres, within a kilometre of the origin.",
        "Write `\"x_mm\": [from, to]` with from below to, and `y_mm` alike.";
    REGION_OVERLAP Error:
        "Two surfaces on one layer overlap.",
        "It is undefined which of them the finger feels.",
        "Move one of them, or give one a higher `layer`.";
    REGION_UNKNOWN_POSITION Error:
        "The position of the finger is not given.",
        "There are several surfaces, or one in a region, and the constant motion does not say where it starts.",
        "Add `from_mm`, or leave one surface without a region.";
    MOTION_INVALID Error:
        "A number of the motion is out of range.",
        "Speed is 0 to 10000 mm/s and force 0 to 1000 N; positions are within a kilometre of the origin.",
        "Correct it; a direction is given by `direction_deg`, not by a sign.";
    DURATION_INVALID Error:
        "The duration is out of range.",
        "It is more than 0 and at most 1e9 seconds.",
        "Correct it, or leave it out: a trace has its own, and other motions continue until they are stopped.";
    BUDGET_INVALID Error:
        "A budget is not a positive number.",
        "Every chain takes time, and every representation has an error.",
        "Correct it, or leave it out.";
    DEVICE_FIELD_INVALID Error:
        "A number of `device` is out of range.",
        "Values out of range give silence, or signals beyond the range of any device.",
        "Correct it to what the message allows, or leave it out.";
    ASSET_MISSING Error:
        "A surface's asset is missing.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or copy the asset to it.";
    ASSET_INVALID Error:
        "A surface's asset cannot be used.",
        "It is not a valid asset, or brings a model that cannot be loaded.",
        "Check it with `htex validate`.";
    REPRESENTATION_MISSING Error:
        "The asset does not have the representation that the scene asks for.",
        "Another model would not feel as intended.",
        "Name one that it has (`htex info`), or `auto`.";
    REPRESENTATION_UNPLAYABLE Error:
        "The asset's representation cannot be played here.",
        "Its model is not installed, is of another version, or refuses the parameters.",
        "Install the model as a plugin, or name another representation.";
    TRACE_MISSING Error:
        "The trace is missing.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or copy the trace to it.";
    TRACE_INVALID Error:
        "The trace cannot be read.",
        "It is a CSV with the columns `t_s`, `x_mm`, `y_mm`, `force_n`, with ascending time.",
        "Correct it at the line the message names.";
    TRACE_ASSUMED Warning:
        "An assumption was made about the trace.",
        "A column without a unit, or an unused one, may not be interpreted as intended.",
        "Name the columns `t_s`, `x_mm`, `y_mm`, `force_n`, `speed_mm_s`.";
    DURATION_BEYOND_TRACE Warning:
        "The scene lasts longer than its trace.",
        "After its last row there is no contact.",
        "Shorten `duration_s`, or leave it out.";
    MOTION_BEYOND_RECORDED Warning:
        "A texture is played as if at another speed or force than the motion's.",
        "The effects that follow the law of the asset are off, or the speed is not within 1/16 to 8 times the nearest recorded one.",
        "Stay within the recorded conditions (`htex info`), or record the texture at such a motion too.";
    RESPONSE_MISSING Error:
        "The response is missing.",
        "Relative paths start at the scene's folder.",
        "Correct the path, or copy the response to it.";
    RESPONSE_INVALID Error:
        "The response cannot be read.",
        "It is a CSV with the columns `frequency_hz`, ascending, and `magnitude`, not negative and not all 0.",
        "Correct it at the line the message names.";
    RESPONSE_RAISED Warning:
        "The compensation of the response raises a part of the band by more than 10 dB.",
        "The device plays that part stronger than the texture by as much: it may reach its limit, and errors of the response are amplified.",
        "Check the response at these frequencies, or limit the compensation by a lower `response_depth_db`.";
    DEVICE_UNKNOWN Error:
        "The device adapter is unknown.",
        "The meaning of the samples depends on the device.",
        "Correct the name; `htex device list` shows the available ones.";
    DEVICE_PATH_UNSAFE Error ("set"):
        "A setting of the scene names a driver.",
        "A scene may come from an untrusted source: playing it must not load code.",
        "Give the `setting` to the player instead.";
    DEVICE_PATH_UNUSED Warning ("set"):
        "A setting of the scene names a file to write.",
        "A scene may come from an untrusted source: only the user chooses which files are written.",
        "Give the `setting` to the player instead; remove it from the scene.";
    DEVICE_HARDWARE Warning ("profile", "set"):
        "The scene describes the hardware, or exceeds a limit.",
        "A wrong gain or limit can apply hundreds of volts more to a finger. Settings of the \
         hardware come from a profile or from the user; a scene can only ask for a lower limit, a shorter buffer or a longer ramp.",
        "Give the `profile` of the rig to the player; remove the setting from the scene.";
    DEVICE_SETTING Error ("set"):
        "A profile or a setting of the device cannot be used.",
        "It is unknown, missing, or has an invalid value.",
        "Correct it; `htex device info` shows settings and profiles.";
    DEVICE_ABSENT Warning:
        "The device cannot be queried.",
        "It is not connected or its driver is not installed, so rules that depend on it are not checked.",
        "Connect it and validate again; on a machine without the device this is expected.";
    DEVICE_RATE Error:
        "The device does not run at this rate.",
        "At another rate all frequencies would be wrong; below 2.5 times a display's carrier, the carrier would be a direct voltage.",
        "Choose one of its rates, or leave `rate_hz` out.";
    DEVICE_FIELD_UNFIT Error:
        "A key of `device` does not apply to the device's quantity.",
        "`gain_db` applies to newtons and other physical quantities, `drive_v` to volts at a display, `level_dbfs` and `pitch` to sound, and \
         `levels` to the last two; `reference_rms` applies to the levels `own` only.",
        "Leave it out, or choose another device.";
    DEVICE_QUANTITY Error:
        "The device does not take the quantity of the assets, or `quantity_gain` is given although it does.",
        "An acceleration of 1 m/s2 is not a force of 1 N: the conversion must be given explicitly.",
        "Choose a device or a setting that takes the assets' quantity, or give `quantity_gain`; leave it out if \
         device and assets agree, or for sound.";
    QUANTITIES_DIFFER Error:
        "The assets of a scene hold different quantities.",
        "One device plays them all, and levels of different quantities cannot be compared.",
        "Use assets of one quantity, or one scene per quantity.";
    DEVICE_DRIVE_TOO_HIGH Error:
        "`drive_v` is above the device's limit.",
        "Voltages beyond the limit are clipped, and the texture would not feel as intended.",
        "Lower it.";
}
