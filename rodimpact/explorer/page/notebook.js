// A page in the output of a notebook cell: it tells the kernel the case that its sliders say.

const REST = 100; // ms without a message, after which the case is sent to the kernel

function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.srcdoc = model.get("page");
  frame.title = "Elastic rods collide";
  Object.assign(frame.style, { width: "100%", height: "58rem", border: 0 });
  let resting = 0;
  const send = (text) => {
    model.set("case", text);
    model.save_changes();
  };
  const take = ({ source, data }) => {
    const text = data && data.rodimpact;
    if (source !== frame.contentWindow || typeof text !== "string") return;
    clearTimeout(resting);
    resting = setTimeout(send, REST, text);
  };
  addEventListener("message", take);
  el.append(frame);
  return () => removeEventListener("message", take);
}

export default { render };
