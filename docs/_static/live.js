// A click on the picture of a robot starts its live page in the place of the picture.
document.addEventListener("click", (event) => {
  const link = event.target.closest("a.live");
  if (!link || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  const frame = document.createElement("iframe");
  frame.className = "live";
  frame.title = link.title;
  frame.src = link.href;
  link.replaceWith(frame);
});
