// Inverse depth of a fragment as layers hold it: from the view's base (PinholeView.base_w).

#ifndef FRAGMENT_W
#define FRAGMENT_W
uniform vec2 w_of_depth;    // factor and term for the depth buffer's value, 1/m; 0 for the perspective division (drawing_space.py)

float fragment_w()
{
    return w_of_depth.x > 0.0 ? w_of_depth.x * gl_FragCoord.z + w_of_depth.y : gl_FragCoord.w;
}
#endif
