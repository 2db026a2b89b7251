// The page in the output of a notebook cell: the case of its sliders goes to the kernel.
// Begin with `render`, which anywidget calls.

const SEND_DELAY = 100; // ms without a message before the case is sent

/** Show the page in an element; returns a function that ends the listening. */
function render({ model, el }) {
  const frame = document.createElement("iframe");
  frame.srcdoc = model.get("page");
  frame.title = "Elastic rods collide";
  Object.assign(frame.style, { width: "100%", height: "58rem", border: 0 });
  let timer = 0;
  const send = (text) => {
    model.set("case", text);
    model.save_changes();
  };
  const receive = ({ source, data }) => {
    const text = data?.rodimpact;
    if (source !== frame.contentWindow || typeof text !== "string") {
      return;
    }
    clearTimeout(timer);
    timer = setTimeout(send, SEND_DELAY, text);
  };
  addEventListener("message", receive);
  el.append(frame);
  return () => removeEventListener("message", receive);
}

export default { render };
