// Annotated pictures; a click shows their frame in the replay.

import {element, figure} from './format.mjs';

export function showPictures(run, playback) {
  if (run.pictures.length === 0) {
    document.getElementById('pictures').hidden = true;
    return;
  }
  for (const {src, seq, time_s} of run.pictures) {
    const caption = `frame ${seq}, ${figure(time_s)} s`;
    const button = element('button', {type: 'button', title: 'Show this frame in the replay'},
      element('figure', {}, element('img', {src, alt: `Left image of ${caption}, points and outlines by object`}),
        element('figcaption', {textContent: caption})));
    button.addEventListener('click', () => {
      playback.seekTime(time_s);
      document.getElementById('replay').scrollIntoView({behavior: 'smooth'});
    });
    document.getElementById('picture-grid').append(button);
  }
}
