"""Solutions, and what is made of them: views, certificates, stresses, derivatives, and the file."""
