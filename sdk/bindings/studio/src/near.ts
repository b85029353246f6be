// What is near the part of a screen that is seen.

/** How near, in CSS pixels. */
const NEAR_PX = 600;

const observers = new Map<Element | null, IntersectionObserver>();
const watched = new WeakMap<Element, (isNear: boolean) => void>();

/** One observer serves all elements of a screen. */
function observerOf(root: Element | null) {
  const own = observers.get(root);
  if (own) return own;
  const tell = (seen: IntersectionObserverEntry[]) => seen.forEach(({ target, isIntersecting }) => watched.get(target)?.(isIntersecting));
  const made = new IntersectionObserver(tell, { root, rootMargin: `${NEAR_PX}px` });
  observers.set(root, made);
  return made;
}

/** Tells when an element comes near, and when it is far again. Returns a function that ends this. */
export function watchNear(element: Element, told: (isNear: boolean) => void) {
  const observer = observerOf(element.closest(".screen"));
  watched.set(element, told);
  observer.observe(element);
  return () => {
    observer.unobserve(element);
    watched.delete(element);
  };
}
