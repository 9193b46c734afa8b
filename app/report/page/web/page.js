// What a page does besides its view: pictures that open large, curves that show the moment.
function enlargePictures() {
  const dialog = document.createElement('dialog');
  const large = document.createElement('img'), words = document.createElement('p');
  dialog.append(large, words);
  document.body.append(dialog);
  dialog.onclick = () => dialog.close();
  for (const picture of document.querySelectorAll('figure img')) {
    picture.onclick = () => {
      large.src = picture.src;
      large.alt = words.textContent = picture.alt;
      dialog.showModal();
    };
  }
}

function linkCurves(view) {
  const curves = [...document.querySelectorAll('.curve svg')];
  const attemptOf = svg => Number((svg.closest('[data-attempt]') || {dataset: {attempt: 0}})
      .dataset.attempt);
  const times = svg => ['left', 'right', 'end'].map(name => Number(svg.dataset[name]));
  view.listeners.push(seconds => curves.forEach(svg => {
    const [left, right, end] = times(svg);
    const x = left + Math.min(1, seconds[attemptOf(svg)] / end) * (right - left);
    svg.querySelector('.now').setAttribute('transform', `translate(${x} 0)`);
  }));
  for (const svg of curves) {
    svg.onclick = e => {
      const [left, right, end] = times(svg);
      const box = svg.getBoundingClientRect();
      const x = (e.clientX - box.left) / box.width * svg.viewBox.baseVal.width;
      view.setTime(Math.max(0, (x - left) / (right - left)) * end);
    };
  }
}

function linkRows(view) {
  for (const button of document.querySelectorAll('button[data-measure]')) {
    const number = view.pins.findIndex(pin => pin.name === button.dataset.measure &&
                                       pin.attempt === Number(button.dataset.attempt));
    button.onclick = () => {
      view.jump(number);
      view.root.scrollIntoView({block: 'nearest'});
    };
  }
}

enlargePictures();
try {
  const data = JSON.parse(document.getElementById('sulcus-data').textContent);
  const view = new Viewer(document.getElementById('viewer'), data.attempts);
  window.sulcusView = view;
  linkCurves(view);
  linkRows(view);
  view.tell();
} catch (error) {
  const stage = document.querySelector('.stage');
  const words = document.createElement('p');
  words.className = 'sadly';
  words.textContent = `The view cannot be drawn: ${error.message}`;
  stage.replaceChildren(words);
}
