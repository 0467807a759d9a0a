"""What the report says in words: captions, the method in plain language, its limits."""

from __future__ import annotations

from install_mpm.conventions import Kinematics

CAPTIONS = {
    "force": """Force that the rig applies while the pile is jacked, and the soil's upward reaction
        on base and shaft, of the whole pile.""",
    "points": """Background mesh and material points. The bands were level before the installation.
        The mesh follows the pile, the points follow the soil.""",
    "stress": """What the installation left in the ground: change of mean pressure (compression
        positive), share of the undrained shear strength that is mobilised, and displacement.
        Every place shows its nearest material point.""",
    "newton": """Newton's method in the installation. Left: relative out-of-balance force of every
        step. Middle: order of the last iterations; 2 is quadratic, the line is at 1.8. Right:
        iterations, and how often a step was halved.""",
    "irregular": """What the scheme had to treat in each step: cells that are not full, places
        without a material point, points that left the mesh; and the shape of the worst cell
        (1 is equilateral).""",
    "handed_off": """The ground changes its model: mesh of the service stage, and the change of mean
        pressure in the material points and, after equilibration, in the finite elements.""",
    "tractions": """Contact pressure under the base and shear along the shaft at the end of the
        installation, in both models.""",
    "curves": """Head load against displacement, installed and wished in place. Dot: load at 0.1 B.
        Cross: where initial and final tangent meet.""",
    "continuity": """Continuity: the pile is pushed on in the finite-element model as if the rig had
        not stopped. The line should go on without a jump.""",
    "mechanism": """Displacement of the ground and plastic shear strain in the programme “{}”, since
        its start.""",
}
"""Captions of the figures by name."""

METHOD = """
<h3>How the figures were found</h3>
<p><b>Installation.</b> The soil is followed by material points: small parcels that keep their mass
and carry stress and strength wherever they go. In each step the pile is pushed down a little; on a
background mesh that follows the pile, the displacement is found at which soil, interface and
pile are in equilibrium. The parcels take that displacement, then the mesh is reset. The
deformation may be as large as it likes, because the mesh never keeps it. A step counts only if the
out-of-balance force has vanished to the tolerance of the case; otherwise it is halved and tried
again.</p>
<p><b>Hand-over.</b> A finite-element mesh is made that fits the pile at its new depth and the
ground surface as it now is. Stresses are carried over by a local linear fit to the parcels,
returned to the yield surface where the fit left it, and released to exact equilibrium while the
pile is held. The certificate says what each of these operations changed.</p>
<p><b>Service.</b> The finite-element model, with the same soil and interface laws, is unloaded,
loaded and pulled. The pile <i>wished in place</i> is the same model at the same depth in ground
that no installation has disturbed. The difference between the two is the effect of the
installation.</p>
"""

SHAPE_LIMITS = {
    Kinematics.PLANE_STRAIN: """Plane strain: the pile is a long wall of width B, not a round pile.
        Factors for shape do not follow from it. Forces are per metre run.""",
    Kinematics.AXISYMMETRIC: """Axisymmetry: the pile is round with diameter B, and nothing acts
        sideways or turns it. Forces are for the whole pile.""",
}
"""What the kinematics of a case mean for its results."""

LIMITS = """
<h3>What limits the answer</h3>
<ul>
<li>{shape}</li>
<li>Undrained, total stress, rate-independent: no pore pressure, no consolidation (set-up), no
cyclic degradation. Strength does not change by remoulding.</li>
<li>The installation starts with a pile that is wished in place at its first depth; only the
penetration that is modelled disturbs the ground.</li>
<li>The pile is rigid; with <code>[service.pile]</code> it is elastic in service.</li>
<li>Unless the case gives the interface friction, it is bonded in the normal direction, so that
suction can act in uplift; its adhesion is that of the undisturbed ground at the level of the
pile.</li>
<li>The service stage takes small strains: displacements beyond about a tenth of the pile's width
are outside its range.</li>
<li>One mesh gives one answer. The error of the mesh is known only after the case has been run on
a finer one; the resistance of the base is the most sensitive figure.</li>
<li>Side and bottom of the box are supported at a finite distance; a wider box may give other
figures.</li>
</ul>
"""
