"use strict";
// The page holds its script compressed.

/** A text that is compressed. */
function unpacked(letters) {
  const bytes = Uint8Array.from(atob(letters), (letter) =>
    letter.charCodeAt(0),
  );
  return new Response(
    new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")),
  ).text();
}

unpacked(document.getElementById("packed").textContent).then((text) => {
  const script = document.createElement("script");
  script.textContent = text;
  document.head.append(script);
});
