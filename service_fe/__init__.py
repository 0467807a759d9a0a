"""Stage 3: finite-element analysis of the installed pile in service.

The constitutive models are those of `install_mpm.constitutive`, called by
`service_fe.material_map`.
"""

# Before any import of dolfinx: an h5py with an HDF5 of its own cannot be loaded after it.
import h5py  # noqa: F401
