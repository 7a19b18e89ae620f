'use strict';
// Draws what has vertices of its own in each picture: the cut of the clip plane, arrows, surfaces and places.

/** Fills the cut of the clip plane through the bodies. */
function drawCut(viewer, copy) {
  const { gl, run, show } = viewer;
  const cut = new Cut(run, viewer.places(), viewer.now());
  cut.at(planeBack(copy, viewer.clip()));
  const byField = show.field >= 0;
  const colours = [];
  run.bodies.forEach((body, k) => {
    if (show.hidden.has(k)) return;
    const start = cut.triangles.count;
    cut.through(body.elements);
    colours.push([byField ? GREY : BODIES[k % BODIES.length], start, cut.triangles.count - start]);
  });
  viewer.use(viewer.free, copy);
  gl.uniform4fv(viewer.program.at.clip, NO_PLANE);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1, 1);
  stream(viewer, cut.triangles.all());
  viewer.take('vertex', viewer.moving, [4, gl.FLOAT, false]);
  for (const [colour, start, count] of colours) {
    viewer.paint(colour, { byField, isLit: true });
    gl.drawArrays(gl.TRIANGLES, start, count);
  }
  gl.disable(gl.POLYGON_OFFSET_FILL);
  if (show.mesh) {
    stream(viewer, cut.lines.all());
    viewer.take('vertex', viewer.moving, [4, gl.FLOAT, false]);
    viewer.paint([0.1, 0.12, 0.18, 0.22]);
    gl.drawArrays(gl.LINES, 0, cut.lines.count);
  }
  viewer.leave();
}

/** Puts numbers of this picture into the buffer for them. */
function stream({ gl, moving }, data) {
  gl.bindBuffer(gl.ARRAY_BUFFER, moving);
  gl.bufferData(gl.ARRAY_BUFFER, data, gl.STREAM_DRAW);
}

/** Draws arrows, six numbers each. They are seen through bodies: contact is between them. */
function drawWays(viewer, arrows, copy, colour) {
  const { gl } = viewer;
  viewer.use(viewer.ofArrows, copy);
  stream(viewer, arrows);
  viewer.take('tail', viewer.moving, [3, gl.FLOAT, false], 24, 0, 1);
  viewer.take('way', viewer.moving, [3, gl.FLOAT, false], 24, 12, 1);
  viewer.take('corner', viewer.arrow, [2, gl.FLOAT, false]);
  viewer.paint(colour);
  gl.disable(gl.DEPTH_TEST);
  gl.drawArraysInstanced(gl.TRIANGLES, 0, SHAPE.length, arrows.length / 6);
  gl.enable(gl.DEPTH_TEST);
  viewer.leave();
}

/** Draws triangles, lines or points, four numbers a vertex. */
function drawFree(viewer, vertices, mode, colour) {
  const { gl } = viewer;
  viewer.use(viewer.free, IDENTITY);
  stream(viewer, vertices);
  viewer.take('vertex', viewer.moving, [4, gl.FLOAT, false]);
  gl.uniform1f(viewer.program.at.pointSize, 9 * viewer.frame.ratio);
  viewer.paint(colour, { isLit: mode === gl.TRIANGLES, isRound: mode === gl.POINTS });
  gl.drawArrays(mode, 0, vertices.length / 4);
  viewer.leave();
}
