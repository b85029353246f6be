//! Libraries that change without their recordings: `htex lib edit`, `merge`, and `pack` of
//! libraries.

use serde_json::Value;

use crate::common::{Place, entries};

/// Three woods and a cloth, and a file beside them.
fn place() -> Place {
    let place = Place::new();
    for (name, tag) in
        [("wood/oak", "hard"), ("wood/birch", "soft"), ("wood/elm", "hard"), ("linen", "soft")]
    {
        std::fs::create_dir_all(place.path("textures/wood")).unwrap();
        make(&place, name, tag, &format!("textures/{name}.htex"));
    }
    make(&place, "Silk", "soft", "silk.htex");
    assert_eq!(place.run(&["lib", "pack", "all.htexlib", "textures", "--name", "All"]).code(), 0);
    place
}

fn make(place: &Place, name: &str, tag: &str, file: &str) {
    let by = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02"];
    let at = ["--at", "speed=80,force=0.5", "--license", "CC-BY-4.0", "--author", "Ana"];
    let run = place.run(&[&by[..], &at, &["--name", name, "--tag", tag, "-o", file]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
}

fn names(place: &Place, library: &str) -> Vec<String> {
    let listed = place.json(&["lib", "ls", library, "--json"]);
    let name = |entry: &Value| entry["name"].as_str().unwrap().to_owned();
    listed.as_array().unwrap().iter().map(name).collect()
}

fn manifest(place: &Place, texture: &str) -> Value {
    place.json(&["info", texture, "--json"])["manifest"].clone()
}

fn bytes(place: &Place, file: &str) -> Vec<u8> {
    std::fs::read(place.path(file)).unwrap()
}

/// Each edit gives what `lib pack` writes of the edited files.
#[test]
fn an_edited_library_is_the_packed_one_of_the_edited_files() {
    let place = place();
    place.write("meta.csv", "texture,description,tags\nwood/elm,From a park,hard;old\nlinen,,\n");
    let said = place.json(&[
        "lib",
        "edit",
        "all.htexlib",
        "-o",
        "new.htexlib",
        "--remove",
        "wood/b*",
        "--rename",
        "wood/oak=wood/old oak",
        "--add",
        "silk.htex",
        "--set",
        "license=CC0-1.0",
        "--add-tag",
        "tested",
        "--remove-tag",
        "soft",
        "--table",
        "meta.csv",
        "--json",
    ]);
    let counts = ["removed", "renamed", "added", "edited", "textures"].map(|key| &said[key]);
    assert_eq!(counts, [1, 1, 1, 3, 4], "{said}");
    assert_eq!(names(&place, "new.htexlib"), ["linen", "silk", "wood/elm", "wood/old oak"]);
    let elm = manifest(&place, "new.htexlib#wood/elm");
    assert_eq!(
        [&elm["license"], &elm["author"], &elm["description"], &elm["tags"]],
        [
            &"CC0-1.0".into(),
            &"Ana".into(),
            &"From a park".into(),
            &serde_json::json!(["hard", "old"])
        ]
    );
    assert_eq!(manifest(&place, "new.htexlib#silk")["tags"], serde_json::json!(["tested"]));
    assert_eq!(place.run(&["lib", "verify", "new.htexlib"]).code(), 0);

    // The same by files.
    let edit = |file: &str, more: &[&str]| {
        let run = place.run(&[&["edit", file, "--license", "CC0-1.0"], more].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
    };
    std::fs::remove_file(place.path("textures/wood/birch.htex")).unwrap();
    std::fs::rename(place.path("textures/wood/oak.htex"), place.path("textures/wood/old oak.htex"))
        .unwrap();
    std::fs::rename(place.path("silk.htex"), place.path("textures/silk.htex")).unwrap();
    edit("textures/wood/old oak.htex", &["--tag", "hard,tested"]);
    edit("textures/wood/elm.htex", &["--tag", "hard,old", "--description", "From a park"]);
    edit("textures/silk.htex", &["--tag", "tested"]);
    edit("textures/linen.htex", &["--tag", "tested"]);
    assert_eq!(place.run(&["lib", "pack", "files.htexlib", "textures", "--name", "All"]).code(), 0);
    assert!(bytes(&place, "new.htexlib") == bytes(&place, "files.htexlib"));
}

#[test]
fn filters_choose_what_is_removed_and_edited() {
    let place = place();
    let edit =
        |more: &[&str]| place.json(&[&["lib", "edit", "all.htexlib", "--json"], more].concat());
    let edited = |more: &[&str]| edit(more)["edited"].as_u64().unwrap();
    assert_eq!(edited(&["--set", "author=Ben", "--where", "tag=hard"]), 2);
    // It is there already.
    assert_eq!(edited(&["--set", "author=Ben", "--where", "tag=hard"]), 0);
    assert_eq!(edited(&["--add-tag", "x", "--where", "author=B*", "--where", "name=wood/e*"]), 1);
    assert_eq!(edited(&["--add-tag", "y", "--where", "license=CC-*", "--where", "model=sbeta"]), 4);
    assert_eq!(edited(&["--set", "law=level-speed=0.4", "--where", "name=linen"]), 1);
    let law = &manifest(&place, "all.htexlib#linen")["law"]["level_speed"];
    assert_eq!([&law["exponent"], &law["source"]], [&Value::from(0.4), &Value::from("given")]);
    assert_eq!(edited(&["--add-tag", "z", "--where", "quantity=acceleration"]), 0);
    let before = names(&place, "all.htexlib");
    assert_eq!(edit(&["--remove", "**", "--where", "author=Ben"])["removed"], 2);
    assert_eq!(names(&place, "all.htexlib"), ["linen", "wood/birch"]);
    assert_eq!(before.len(), 4);
}

#[test]
fn a_wrong_edit_changes_nothing() {
    let place = place();
    let before = (bytes(&place, "all.htexlib"), entries(&place.path("")));
    place.write("unlicensed.csv", "texture,license\nlinen,\n");
    place.write("strange.csv", "texture,colour\nlinen,red\n");
    place.write("absent.csv", "texture,author\nlinnen,Ana\n");
    place.write("twice.csv", "texture,author\nlinen,Ana\nlinen,Ben\n");
    for (more, words) in [
        (&[][..], "nothing to change"),
        (
            &["--remove", "wood/okk"],
            "no texture wood/okk in the library; its most similar names are wood/oak",
        ),
        (&["--remove", "stone/*"], "no texture is called stone/*"),
        (&["--rename", "oak=elm"], "no texture oak in the library"),
        (&["--rename", "linen=wood/oak"], "two textures have the name wood/oak"),
        (&["--rename", "linen=WOOD/OAK"], "differ only in case"),
        (&["--rename", "linen"], "OLD=NEW"),
        (&["--rename", "linen=a", "--rename", "linen=b"], "linen would get two names"),
        (&["--add", "textures/linen.htex"], "two textures have the name linen"),
        (&["--add", "none.htex"], "none.htex"),
        (
            &["--set", "licence=CC0-1.0"],
            "there is no field licence; there are name, author, license",
        ),
        (&["--set", "license=(("], "license"),
        (&["--set", "license="], "and 3 other textures state no licence"),
        (&["--where", "colour=red", "--add-tag", "x"], "there are name, tag, model"),
        (&["--table", "strange.csv"], "there is no column `colour`"),
        (&["--table", "absent.csv"], "its most similar names are linen"),
        (&["--table", "twice.csv"], "line 3"),
    ] {
        let run = place.run(&[&["lib", "edit", "all.htexlib"], more].concat());
        assert!(run.code() != 0 && run.error().contains(words), "{more:?}: {}", run.error());
        assert!(bytes(&place, "all.htexlib") == before.0, "{more:?}");
    }
    let left: Vec<String> =
        entries(&place.path("")).into_iter().filter(|n| !n.ends_with(".csv")).collect();
    assert_eq!(left, before.1);
    // An empty cell changes nothing.
    let same = place.json(&["lib", "edit", "all.htexlib", "--table", "unlicensed.csv", "--json"]);
    assert_eq!(same["edited"], 0);
    assert!(bytes(&place, "all.htexlib") == before.0);
}

#[test]
fn merged_libraries_are_packed_ones() {
    let place = place();
    let run = |arguments: &[&str]| {
        let run = place.run(arguments);
        assert_eq!(run.code(), 0, "{arguments:?}: {}", run.error());
    };
    run(&["lib", "pack", "some.htexlib", "textures/linen.htex", "silk.htex", "--name", "Some"]);
    // The equal texture `linen` of both is no conflict.
    run(&["lib", "merge", "all.htexlib", "some.htexlib", "-o", "both.htexlib", "--name", "Both"]);
    run(&["lib", "pack", "packed.htexlib", "textures", "silk.htex", "--name", "Both"]);
    assert!(bytes(&place, "both.htexlib") == bytes(&place, "packed.htexlib"));
    run(&["lib", "pack", "again.htexlib", "all.htexlib", "some.htexlib#silk", "--name", "Both"]);
    assert!(bytes(&place, "again.htexlib") == bytes(&place, "packed.htexlib"));

    run(&["lib", "merge", "all.htexlib", "some.htexlib", "--prefix", "a/,b/", "-o", "two.htexlib"]);
    assert_eq!(names(&place, "two.htexlib").len(), 6);
    run(&["lib", "edit", "some.htexlib", "--set", "author=Ben"]);
    let merge = ["lib", "merge", "all.htexlib", "some.htexlib", "-o", "both.htexlib"];
    let before = bytes(&place, "both.htexlib");
    place.run(&merge).failed(1, &["1 names have different textures", "linen"]);
    assert!(bytes(&place, "both.htexlib") == before);
    for (choice, author) in [("first", "Ana"), ("last", "Ben")] {
        run(&[&merge[..], &["--on-conflict", choice]].concat());
        assert_eq!(manifest(&place, "both.htexlib#linen")["author"], author);
    }
    place.run(&[&merge[..], &["--prefix", "a/"]].concat()).failed(2, &["there are 2 libraries"]);
}

#[test]
fn a_difference_is_told_in_detail() {
    let place = place();
    let by = ["make", "--model", "sbeta", "--set", "alpha=3", "beta=3", "--level", "0.04"];
    let birch = ["--at", "speed=80,force=0.5", "--license", "CC0-1.0", "--name", "Birch"];
    assert_eq!(place.run(&[&by[..], &birch, &["-o", "birch.htex"]].concat()).code(), 0);
    let edit = [
        "lib",
        "edit",
        "all.htexlib",
        "-o",
        "new.htexlib",
        "--remove",
        "wood/elm",
        "--rename",
        "wood/oak=wood/ash",
        "--remove",
        "wood/birch",
        "--add",
        "silk.htex",
    ];
    assert_eq!(place.run(&edit).code(), 0);
    std::fs::create_dir_all(place.path("more/wood")).unwrap();
    std::fs::rename(place.path("birch.htex"), place.path("more/wood/birch.htex")).unwrap();
    let more = [
        "lib",
        "edit",
        "new.htexlib",
        "--add",
        "more",
        "--set",
        "author=Ben",
        "--where",
        "name=linen",
    ];
    assert_eq!(place.run(&more).code(), 0);

    let diff = ["lib", "diff", "all.htexlib", "new.htexlib", "--details"];
    let run = place.run(&[&diff[..], &["--json"]].concat());
    assert_eq!(run.code(), 1);
    let said: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!(said["removed"], serde_json::json!(["wood/elm"]));
    assert_eq!(said["added"], serde_json::json!(["silk"]));
    assert_eq!(said["renamed"], serde_json::json!([{ "from": "wood/oak", "to": "wood/ash" }]));
    let [linen, birch] = [&said["changed"][0], &said["changed"][1]];
    assert_eq!(
        linen["metadata"],
        serde_json::json!([{ "name": "author", "from": "Ana", "to": "Ben" }])
    );
    assert_eq!(linen["models"][0]["at"], serde_json::json!([]));
    let at = &birch["models"][0]["at"][0];
    // The command measures the same of the files.
    let compared =
        place.json(&["compare", "all.htexlib#wood/birch", "new.htexlib#wood/birch", "--json"]);
    assert_eq!(&compared["models"][0]["at"][0], at);
    assert!((at["level_db"].as_f64().unwrap() - 6.02).abs() < 0.3, "{at}");
    assert!(at["felt"]["largest_error_db"].as_f64().unwrap().abs() > 1.6);

    let markdown = place.run(&[&diff[..], &["--markdown"]].concat()).text();
    let lines = [
        "### Added\n\n- `silk`\n",
        "- `wood/oak` → `wood/ash`",
        "  - author: Ana → Ben",
        "  - sbeta at 80 mm/s, 0.5 N: level +",
    ];
    for line in lines {
        assert!(markdown.contains(line), "{line} in {markdown}");
    }
    for (limit, code) in [("felt=1.6", 1), ("felt=1000", 0)] {
        assert_eq!(place.run(&[&diff[..], &["--fail-on", limit]].concat()).code(), code, "{limit}");
    }
    place.run(&[&diff[..], &["--fail-on", "nine=1"]].concat()).failed(2, &["felt="]);
    let same = place.run(&["compare", "silk.htex", "new.htexlib#silk"]);
    assert_eq!((same.code(), same.text()), (0, "nothing differs\n".to_owned()));
}

#[test]
fn a_library_is_exported_with_a_table_of_what_is_lost() {
    let place = place();
    let export = ["lib", "export", "all.htexlib", "--to", "ahap,wav,gltf", "-o", "out"];
    let run = place.run(&[&export[..], &["--where", "tag=hard", "--seconds", "0.5"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    assert_eq!(run.text(), "out: 6 of 6 files, and exported.csv\n");
    let table = String::from_utf8(bytes(&place, "out/exported.csv")).unwrap();
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 7, "{table}");
    assert!(rows[0].starts_with("texture,format,file,bytes,level_db,felt_rms_db"), "{table}");
    assert!(rows[1].starts_with("wood/elm,ahap,wood/elm.ahap,"), "{table}");
    // The bytes are those of `htex export`.
    let one =
        ["export", "all.htexlib#wood/oak", "--to", "ahap", "--seconds", "0.5", "-o", "oak.ahap"];
    assert_eq!(place.run(&one).code(), 0);
    assert!(bytes(&place, "out/wood/oak.ahap") == bytes(&place, "oak.ahap"));
    place.run(&export).failed(1, &["it is there already", "--force"]);

    // A texture that cannot be exported is in the table, and the others are exported.
    let silent = ["--level", "0", "--license", "CC0-1.0", "--at", "speed=80,force=0.5"];
    let by = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5"];
    assert_eq!(place.run(&[&by[..], &silent, &["-o", "silent.htex"]].concat()).code(), 0);
    assert_eq!(place.run(&["lib", "edit", "all.htexlib", "--add", "silent.htex"]).code(), 0);
    let run = place.run(&["lib", "export", "all.htexlib", "--to", "ahap", "-o", "again", "--json"]);
    assert_eq!(run.code(), 3, "{}", run.error());
    let said: Value = serde_json::from_str(&run.text()).unwrap();
    let failed = said.as_array().unwrap().iter().filter(|row| row.get("problem").is_some());
    let failed: Vec<_> = failed.map(|row| &row["texture"]).collect();
    assert_eq!(failed, ["silent"], "{said}");
}

/// At any write, and at any time.
#[cfg(unix)]
#[test]
fn a_killed_change_leaves_the_old_library_or_the_new_one() {
    use std::process::{Command, Stdio};
    use std::time::Duration;

    let place = place();
    assert_eq!(place.run(&["lib", "pack", "some.htexlib", "silk.htex"]).code(), 0);
    for arguments in [
        &["lib", "edit", "changed.htexlib", "--add-tag", "x"][..],
        &["lib", "merge", "all.htexlib", "some.htexlib", "-o", "changed.htexlib"],
    ] {
        let restore =
            || std::fs::copy(place.path("all.htexlib"), place.path("changed.htexlib")).unwrap();
        restore();
        assert_eq!(place.run(arguments).code(), 0);
        let (old, new) = (bytes(&place, "all.htexlib"), bytes(&place, "changed.htexlib"));
        assert!(old != new);
        let (mut kept, mut changed) = (0, 0);
        let mut check = |how: &str| {
            let now = bytes(&place, "changed.htexlib");
            assert!(now == old || now == new, "{arguments:?} {how}");
            *if now == old { &mut kept } else { &mut changed } += 1;
        };
        // A write beyond this size ends the process.
        for blocks in 0..=new.len() / 512 + 1 {
            restore();
            let mut shell = Command::new("sh");
            shell.args(["-c", "ulimit -f \"$0\"; exec \"$@\"", &blocks.to_string()]);
            shell.arg(env!("CARGO_BIN_EXE_htex")).args(arguments).current_dir(place.path(""));
            let _ = shell.stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap();
            check(&format!("at {blocks} blocks"));
        }
        for step in 0..40 {
            restore();
            let mut child = place.command(arguments).stdout(Stdio::null()).spawn().unwrap();
            std::thread::sleep(Duration::from_micros(500 * step));
            let _ = child.kill();
            child.wait().unwrap();
            check(&format!("after {step} half milliseconds"));
        }
        assert!(kept > 0 && changed > 0, "{kept} {changed}");
    }
}
