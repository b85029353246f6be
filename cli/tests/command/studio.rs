//! `htex studio`: which folder it serves. `sdk/bindings/studio/tests/served.test.mjs` opens what is served.

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::process::Stdio;
use std::time::Duration;

use crate::browser::Browser;
use crate::common::Place;

#[test]
fn a_folder_without_the_page_is_refused_with_how_to_build_it() {
    let place = Place::new();
    let run = place.run(&["studio", "--folder", "."]);
    assert_eq!(run.code(), 1, "{}", run.error());
    for words in ["is not in .;", "cargo xtask studio --out DIR", "HTEX_STUDIO=DIR"] {
        assert!(run.error().contains(words), "{}", run.error());
    }
}

#[test]
fn a_page_that_is_too_large_names_the_file() {
    let place = Place::new();
    place.write("index.html", "<title>studio</title>");
    let large = std::fs::File::create(place.path("large.wasm")).unwrap();
    large.set_len(65 << 20).unwrap();
    let run = place.run(&["studio", "--folder", ".", "--port", "0"]);
    assert_eq!(run.code(), 1, "{}", run.error());
    assert!(run.error().contains("large.wasm"), "{}", run.error());
}

/// The scripts of a page that somebody else made: whatever they do, the tab stays at its address,
/// and nothing of them stays in the browser for what is served there later.
#[test]
fn a_page_leads_nowhere_else_and_leaves_no_service_worker() {
    let installed = crate::browser::installed();
    if !xtask::needs::CHROMIUM.met(installed.is_some()) {
        return;
    }
    let place = Place::new();
    std::fs::create_dir(place.path("page")).unwrap();
    place.write(
        "page/index.html",
        "<!doctype html><html lang=en><head><title>page</title></head><body></body></html>",
    );
    place.write("page/next.html", "<title>next</title>");
    place.write("page/sw.js", "");
    let mut child = place
        .command(&["studio", "--folder", "page", "--port", "0"])
        .env("HTEX_CONFIG_DIR", place.path("own"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    let mut said = BufReader::new(child.stdout.take().unwrap());
    said.read_line(&mut line).unwrap();
    let url = line.split([' ', ';']).find(|word| word.starts_with("http")).unwrap().to_owned();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.set_nonblocking(true).unwrap();
    let elsewhere = format!("http://127.0.0.1:{}/", listener.local_addr().unwrap().port());
    let mut browser = Browser::start(installed.unwrap(), &place.path("browser"));
    let tab = browser.open(&url);
    std::thread::sleep(Duration::from_secs(1));
    let shown = browser.value(&tab, "document.compatMode + ' ' + document.title");
    assert_eq!(shown, "CSS1Compat page");
    let exchanged = "Event.prototype.preventDefault = () => {}; String.prototype.startsWith = () => true; \
        Object.defineProperty(NavigationDestination.prototype, 'url', { get: () => location.href }); location.href = 'TO'";
    let ways = [
        "location.href = 'TO'",
        "window.open('TO', '_self')",
        "window.open('TO')",
        "const a = document.createElement('a'); a.href = 'TO'; document.body.append(a); a.click()",
        "const m = document.createElement('meta'); m.httpEquiv = 'refresh'; m.content = '0;url=TO'; document.head.append(m)",
        "const f = document.createElement('form'); f.action = 'TO'; document.body.append(f); f.submit()",
        "const i = document.createElement('iframe'); document.body.append(i); i.contentWindow.top.location = 'TO'",
        "fetch('TO')",
        "document.open(); document.write('<title>page</title><a href=TO>x</a>'); document.close(); document.querySelector('a').click()",
        exchanged,
    ];
    for way in ways {
        browser.value(&tab, &format!("(() => {{ {} }})()", way.replace("TO", &elsewhere)));
        std::thread::sleep(Duration::from_millis(700));
        assert!(listener.accept().is_err(), "{way}");
        assert_eq!(browser.value(&tab, "document.title"), "page", "{way}");
    }
    browser.reload(&tab);
    std::thread::sleep(Duration::from_secs(1));
    let worker =
        "navigator.serviceWorker.register('sw.js').then(() => 'registered', () => 'refused')";
    assert_eq!(browser.promised(&tab, worker), "refused");
    browser.value(&tab, "location.href = 'next.html'");
    std::thread::sleep(Duration::from_secs(1));
    assert_eq!(browser.value(&tab, "document.title"), "next", "its own pages");
    child.kill().unwrap();
    child.wait().unwrap();
}
