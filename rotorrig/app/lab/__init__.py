"""A lab's runs together: the catalogue of what was identified and diagnosed in every recording of a folder.

`page` writes it as pages for a browser.
"""
