"""A report's page in a real browser, with all that it said and asked for."""

import numpy as np


class Visit:
    """A page opened from its file, with all that it said and asked for."""

    def __init__(self, browser, path, size=(1280, 800)):
        self.page = browser.new_page(viewport={"width": size[0], "height": size[1]})
        self.errors, self.requests, self.dialogs = [], [], []
        self.page.on("console", lambda said: said.type == "error" and self.errors.append(said.text))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("dialog", lambda dialog: (self.dialogs.append(dialog.message), dialog.dismiss()))
        self.page.goto(path.as_uri())
        self.page.wait_for_function("document.querySelector('#joint-plot .plot-container') !== null")

    def trace(self, name):
        """Times and values of a trace of the curve plot."""
        script = "name => { const t = document.getElementById('curve-plot').data.find(t => t.name === name);"
        return np.array(self.page.evaluate(script + " return [[...t.x], [...t.y]] }", name))
