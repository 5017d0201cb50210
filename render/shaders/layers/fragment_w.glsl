// Inverse depth of a fragment as layers hold it: from the view's base (PinholeView.base_w).

#ifndef FRAGMENT_W
#define FRAGMENT_W
uniform float base_w;   // 1/m

float fragment_w()
{
    return gl_FragCoord.w - base_w;
}
#endif
