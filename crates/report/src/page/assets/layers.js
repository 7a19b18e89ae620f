'use strict';
// What a scene has where before its run: surfaces of contacts and ties, couplings, equations, joints, springs, supports, loads and sets, each a layer that is shown or not.

/** Layers that are shown at first: what acts. */
const ACTING = ['contact', 'tie', 'coupling', 'equation', 'joint', 'spring', 'prescribed', 'support', 'load'];
/** Length of the arrows, in parts of the size of what is shown. */
const ARROW_LENGTH = 0.08;

class Layers {
  constructor(app, layers) {
    this.app = app;
    this.list = layers.map((layer, k) => ({ ...layer, colour: COLOURS[k % COLOURS.length], isShown: ACTING.includes(layer.kind) }));
    const kinds = new Map();
    for (const layer of this.list) kinds.set(layer.kind, [...(kinds.get(layer.kind) ?? []), layer]);
    const groups = [...kinds].map(([kind, found]) => this.group(kind, found));
    app.panels.tab('Model').replaceChildren(element('div', { id: 'layers' }, groups));
  }

  /** A list that opens, with a box for each layer. */
  group(kind, layers) {
    const boxes = layers.map((layer) => {
      const box = element('input', { type: 'checkbox', checked: layer.isShown });
      box.onchange = () => {
        layer.isShown = box.checked;
        this.app.redraw();
      };
      const swatch = element('span', { className: 'swatch' });
      swatch.style.background = layer.colour;
      const words = [element('span', { textContent: layer.name }), element('small', { textContent: layer.about })];
      return element('label', { title: layer.about }, [box, swatch, ...words]);
    });
    return element('details', { open: ACTING.includes(kind) }, [element('summary', { textContent: `${kind} (${layers.length})` }), ...boxes]);
  }

  /** Draws what is shown over the bodies. */
  draw(viewer) {
    const { gl } = viewer;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-2, -2);
    for (const layer of this.list.filter(({ isShown }) => isShown)) {
      const rgb = [1, 3, 5].map((k) => parseInt(layer.colour.slice(k, k + 2), 16) / 255);
      const vertices = (places) => Float32Array.from(places.flatMap((place) => [...layer.places[place], NONE]));
      const triangles = layer.facets.flatMap(([a, b, c, d]) => (d === undefined ? [a, b, c] : [a, b, c, a, c, d]));
      const sides = layer.facets.flatMap((facet) => facet.flatMap((place, k) => [place, facet[(k + 1) % facet.length]]));
      // The colours of the field, such as the gap of a contact, are seen through it.
      drawFree(viewer, vertices(triangles), gl.TRIANGLES, [...rgb, 0.3]);
      // Surfaces in contact hide each other, and joints are inside of bodies: all but the facets is seen through them.
      gl.disable(gl.DEPTH_TEST);
      drawFree(viewer, vertices(sides), gl.LINES, [...rgb, 0.6]);
      drawFree(viewer, vertices(layer.lines.flat()), gl.LINES, [...rgb, 1]);
      const single = layer.facets.length ? [] : [...layer.places.keys()];
      drawFree(viewer, vertices(single), gl.POINTS, [...rgb, 1]);
      gl.enable(gl.DEPTH_TEST);
      const length = ARROW_LENGTH * viewer.extent();
      const arrows = layer.arrows.flatMap(({ at, along, pushes }) => {
        const way = scaled(along, length);
        return [...(pushes ? subtract(at, way) : at), ...way];
      });
      drawWays(viewer, Float32Array.from(arrows), IDENTITY, [...rgb, 1]);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }

  /** Names of what is shown and is no set, at the middle of each. */
  names(overlay) {
    for (const { name, kind, places, arrows, colour, isShown } of this.list) {
      const all = places.length ? places : arrows.map(({ at }) => at);
      if (!isShown || kind === 'set' || !all.length) continue;
      overlay.label(scaled(all.reduce(add), 1 / all.length), name, colour);
    }
  }
}
