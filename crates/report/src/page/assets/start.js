'use strict';
// Starts the page.

const started = start().then((app) => {
  document.body.dataset.state = 'ready';
  return app;
});
started.catch((error) => {
  document.body.dataset.state = 'error';
  document.body.prepend(message(error.message));
});
