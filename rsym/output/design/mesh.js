// A body of too many operations for a shader: the page of its mesh, inside this one. Served, a letter makes a new mesh.
const picture = (() => {
  let frame, asked = 0;

  async function remesh() {
    const own = ++asked;
    say("Meshing ...");
    try {
      const text = await (await ask("body.html")).text();
      if (own !== asked) return;
      frame.srcdoc = text;
      say("");
    } catch (error) {
      if (own === asked) say(`Not meshed: ${error.message}`);
    }
  }

  function change(moving) {
    if (moving || !frame) return;
    const moved = data.letters.some((letter, k) => values[k] !== letter.value);
    if (data.served) remesh();
    else say(moved ? "The formula is too long for this page to draw: it shows the mesh of the letters that it was written with." : "");
  }

  function start() {
    frame = made("iframe", {srcdoc: data.mesh, title: `${data.title}, a mesh`});
    byId("stage").append(frame);
    if (values.some((value, k) => value !== data.letters[k].value)) change(false);
  }

  function save(done) {
    const canvas = frame.contentDocument.querySelector("canvas");
    canvas.dispatchEvent(new Event("redraw"));
    canvas.toBlob(done);
  }

  return {fields: {}, controls: () => [], start, change, save};
})();
