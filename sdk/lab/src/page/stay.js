// The first script of each page of a folder. The page's own scripts may be anybody's: this one keeps them from leading the tab to
// another address. What it calls is taken before they run, so that they cannot exchange it.
(() => {
  if (!window.navigation) return; // Older browsers give no say in it.
  const { apply } = Reflect;
  const getter = (of, name) => Object.getOwnPropertyDescriptor(of.prototype, name).get;
  const [destination, url] = [getter(NavigateEvent, "destination"), getter(NavigationDestination, "url")];
  const { preventDefault } = Event.prototype;
  const { startsWith } = String.prototype;
  const { origin } = location;
  navigation.addEventListener("navigate", (event) => {
    const to = apply(url, apply(destination, event, []), []);
    const isOwn = (beginning) => apply(startsWith, to, [beginning]);
    if (!(isOwn(origin + "/") || isOwn("blob:" + origin + "/") || isOwn("data:"))) apply(preventDefault, event, []);
  });
})();
